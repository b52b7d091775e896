// Random numbers in the precision of the path.

FN pair numbers_of(GLOBAL const u32 *words, const sample_key *key, u32 bounce, u32 branch, u32 purpose) {
    word_pair bits = words_of(words, key, bounce, branch, purpose);
    pair numbers;
    numbers.u = UNIT(bits.first);
    numbers.v = UNIT(bits.second);
    return numbers;
}

// One operation per item: `task` has the operation's number, `numbers` two operands, `words` 64 bits; `out` gets the bits of the result.
FN void run_item(u32 item, GLOBAL const real *numbers, GLOBAL const u32 *words, GLOBAL const u32 *task, GLOBAL u64 *out) {
    real a = numbers[2 * item], b = numbers[2 * item + 1], result = 0.0;
    float x = (float)a, y = (float)b;
    u64 bits = ((u64)words[2 * item + 1] << 32) | words[2 * item];
    real chain = a;
    GLOBAL real *real_out = (GLOBAL real *)out;
    switch (task[0]) {
    case 0: result = a + b; break;
    case 1: result = a - b; break;
    case 2: result = a * b; break;
    case 3: result = a / b; break;
    case 4: result = SQUARE_ROOT(a); break;
    case 5: result = a * b + a; break;
    case 6: result = a * b - b * a; break;
    case 7: result = WITH_SIGN(a, b); break;
    case 8: result = MAGNITUDE(a) < b ? a : b; break;
    case 9: result = (real)(bits >> 11); break;
    case 10:
        for (u32 k = 0; k < 200; k++) chain = chain * b + a;
        result = chain;
        break;
    case 11: out[item] = bits * 0x9E3779B97F4A7C15UL + (bits >> 31); return;
    case 12: out[item] = (u64)COUNT_ONES((u32)bits) | ((bits << 13) ^ (bits >> 51)) << 6; return;
    case 13: result = (real)(x + y); break;
    case 14: result = (real)(x * y); break;
    case 15: result = (real)(x / y); break;
    case 16: result = (real)SINGLE_SQUARE_ROOT(x); break;
    case 17: result = (real)(x * y + x); break;
    default: result = (real)FUSED(x, y, -(x * y)); break;
    }
    real_out[item] = result;
}

// A ray through the hierarchy: `scene/hierarchy/traverse.rs`. Boxes are tested in double precision, even if the path is in single precision.

#if HAS_HIERARCHY
FN nearest through_tree(const scene *s, ray way, const shear *by, standpoint from, int only_sure, nearest so_far, tests *t) {
    slabs of = slabs_along(way);
    u32 waiting[DEEPEST];
    exact distances[DEEPEST];
    int count = 0;
    u32 index = 0;
    t->boxes += 1;
    if (enter(&of, s->boxes, so_far.t) < 0) return so_far;
    for (;;) {
        u32 at = s->nodes[2 * index], entries = s->nodes[2 * index + 1];
        if (entries == 0U) {
            t->boxes += 2;
            exact a = enter(&of, s->boxes + 6 * at, so_far.t);
            exact b = enter(&of, s->boxes + 6 * (at + 1), so_far.t);
            if (a >= 0 && b >= 0) {
                int second_first = b < a;
                waiting[count] = second_first ? at : at + 1;
                distances[count] = second_first ? a : b;
                count++;
                index = second_first ? at + 1 : at;
                continue;
            }
            if (a >= 0) { index = at; continue; }
            if (b >= 0) { index = at + 1; continue; }
        } else {
            t->primitives += (u64)entries;
            so_far = in_leaf(s, at, entries, way, by, from, only_sure, so_far);
        }
        do {
            if (count == 0) return so_far;
            count--;
        } while (!(distances[count] <= so_far.t));
        index = waiting[count];
    }
}
#endif

//! Forbidden GPU instructions: fused operations, which are rounded once instead of twice, and operations without a
//! stated rounding.

/// Returns the floating-point instructions of a PTX text that fuse a multiplication and an addition, approximate, flush
/// subnormal numbers to zero, or state no rounding. Fused ones in single precision are allowed, because a program asks
/// for them by name. (The assembler may fuse `add`, `sub` and `mul` without a suffix.)
pub fn inexact_instructions(ptx: &str) -> Vec<&str> {
    let instructions = ptx.lines().map(str::trim).filter(|line| line.ends_with(';'));
    let is_inexact = |line: &&str| {
        // A predicate may stand before the instruction.
        let instruction = line.split_whitespace().find(|word| !word.starts_with('@')).unwrap_or_default();
        let parts: Vec<&str> = instruction.split('.').collect();
        let is_real = parts.iter().any(|part| matches!(part.trim_end_matches(';'), "f64" | "f32" | "f16" | "bf16"));
        let has = |wanted: &str| parts.contains(&wanted);
        is_real
            && match parts[0] {
                "add" | "sub" | "mul" | "div" | "sqrt" | "rcp" => !has("rn") || has("ftz"),
                "fma" => !(has("rn") && has("f32")) || has("ftz"),
                "mad" | "rsqrt" | "sin" | "cos" | "ex2" | "lg2" | "tanh" => true,
                _ => has("approx") || has("ftz"),
            }
    };
    instructions.filter(is_inexact).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_fused_operations_and_undeclared_functions() {
        let ptx = "\tadd.rn.f64 %fd1, %fd2, %fd3;\n\tadd.f64 \t%fd1, %fd2, %fd3;\n\t@%p1 fma.rn.f64 %fd1, %fd2, %fd3, %fd4;\n\
                   \tadd.s64 %rd1, %rd2, %rd3;\n\tmad.lo.s32 %r1, %r2, %r3, %r4;\n\tsqrt.rn.f64 %fd1, %fd2;\n\
                   \tmul.rn.ftz.f32 %f1, %f2, %f3;\n\tld.global.f64 %fd1, [%rd1];\n\trsqrt.approx.ftz.f64 %fd1, %fd2;\n\
                   // add.f64 in a comment\n\tcvt.rn.f64.u64 %fd1, %rd1;\n\tdiv.rn.f64 %fd1, %fd2, %fd3;";
        let found = inexact_instructions(ptx);
        assert_eq!(found.len(), 4, "{found:?}");
        assert!(found[0].starts_with("add.f64") && found[1].contains("fma") && found[2].contains("ftz"), "{found:?}");
        assert!(found[3].starts_with("rsqrt"), "{found:?}");
    }
}

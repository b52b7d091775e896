//! The processor's model, as its maker numbers it: names such as `AMD EPYC` stand for many models.

use std::collections::BTreeSet;

/// The makers' numbers of the processors in the text of /proc/cpuinfo: vendor, family, model and stepping on x86, and
/// implementer, part, variant and revision on ARM. A machine with cores of several kinds has several, separated by
/// commas. Empty if the text has none of them.
pub(super) fn model_numbers(cpuinfo: &str) -> String {
    let kinds: BTreeSet<String> = cpuinfo.split("\n\n").filter_map(one).collect();
    kinds.into_iter().collect::<Vec<_>>().join(", ")
}

/// The numbers of the processor that one paragraph describes.
fn one(paragraph: &str) -> Option<String> {
    let value = |key: &str| {
        let lines = paragraph.lines().filter_map(|line| line.split_once(':'));
        lines.into_iter().find(|(name, _)| name.trim() == key).map(|(_, value)| value.trim())
    };
    let fields = |head: &str, pairs: &[(&str, &str)]| {
        let numbers = pairs.iter().filter_map(|(name, key)| Some(format!(" {name} {}", value(key)?)));
        format!("{head}{}", numbers.collect::<String>())
    };
    if let Some(vendor) = value("vendor_id") {
        return Some(fields(vendor, &[("family", "cpu family"), ("model", "model"), ("stepping", "stepping")]));
    }
    let implementer = value("CPU implementer")?;
    let numbers = [("part", "CPU part"), ("variant", "CPU variant"), ("revision", "CPU revision")];
    Some(fields(&format!("implementer {implementer}"), &numbers))
}

/// The instruction sets of this processor that compilers choose between. Flags of the kernel are not among them: an
/// update of the kernel changes those.
pub(super) fn instruction_sets() -> String {
    macro_rules! detected {
        ($detect:ident: $($name:tt)*) => {
            [$(($name, std::arch::$detect!($name))),*]
        };
    }
    #[cfg(target_arch = "x86_64")]
    let sets = detected!(is_x86_feature_detected:
        "sse3" "ssse3" "sse4.1" "sse4.2" "popcnt" "avx" "avx2" "bmi1" "bmi2" "fma" "f16c" "sha" "vaes" "gfni"
        "avx512f" "avx512bw" "avx512cd" "avx512dq" "avx512vl" "avx512ifma" "avx512vnni" "avx512bf16" "avx512fp16");
    #[cfg(target_arch = "aarch64")]
    let sets = detected!(is_aarch64_feature_detected:
        "neon" "fp16" "dotprod" "lse" "rcpc" "crc" "aes" "sha2" "sha3" "i8mm" "bf16" "sve" "sve2");
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    let sets: [(&str, bool); 0] = [];
    sets.iter().filter(|(_, is_there)| *is_there).map(|(name, _)| *name).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn x86(family: u32) -> String {
        format!(
            "processor\t: 0\nvendor_id\t: AuthenticAMD\ncpu family\t: {family}\nmodel\t\t: 2\nmodel name\t: AMD EPYC\n\
             stepping\t: 1\n\nprocessor\t: 1\nvendor_id\t: AuthenticAMD\ncpu family\t: {family}\nmodel\t\t: 2\n\
             model name\t: AMD EPYC\nstepping\t: 1\n"
        )
    }

    fn arm(part: &str) -> String {
        format!(
            "processor\t: 0\nBogoMIPS\t: 50.00\nFeatures\t: fp asimd\nCPU implementer\t: 0x41\nCPU architecture: 8\n\
             CPU variant\t: 0x3\nCPU part\t: {part}\nCPU revision\t: 1\n"
        )
    }

    #[test]
    fn families_of_one_name_are_different_processors() {
        assert_eq!(model_numbers(&x86(26)), "AuthenticAMD family 26 model 2 stepping 1");
        assert_ne!(model_numbers(&x86(25)), model_numbers(&x86(26)));
    }

    #[test]
    fn arm_processors_have_numbers_instead_of_a_name() {
        assert_eq!(model_numbers(&arm("0xd0c")), "implementer 0x41 part 0xd0c variant 0x3 revision 1");
        let both = format!("{}\n{}", arm("0xd05"), arm("0xd0b"));
        assert_eq!(
            model_numbers(&both),
            "implementer 0x41 part 0xd05 variant 0x3 revision 1, implementer 0x41 part 0xd0b variant 0x3 revision 1"
        );
    }

    #[test]
    fn a_text_without_numbers_gives_none() {
        assert_eq!(model_numbers(""), "");
        assert_eq!(model_numbers("processor\t: 0\nfeatures\t: vx\n"), "");
    }
}

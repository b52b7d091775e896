//! The clock of the processors, where the system tells it.

use std::fs;
use std::path::Path;

/// The mean clock of these processors in MHz: the frequency that their driver reports, or else the one in
/// `/proc/cpuinfo`, which many virtual machines never change. `None` if there is neither. `root` is `/`.
pub fn clock_mhz(root: &Path, cpus: &[usize]) -> Option<f64> {
    let by_driver = |cpu: &usize| {
        let path = root.join(format!("sys/devices/system/cpu/cpu{cpu}/cpufreq/scaling_cur_freq"));
        Some(fs::read_to_string(path).ok()?.trim().parse::<f64>().ok()? * 1e-3)
    };
    mean(&cpus.iter().filter_map(by_driver).collect::<Vec<_>>()).or_else(|| {
        let text = fs::read_to_string(root.join("proc/cpuinfo")).ok()?;
        mean(&text.split("\n\n").filter_map(|paragraph| in_paragraph(paragraph, cpus)).collect::<Vec<_>>())
    })
}

/// The clock of one processor in `/proc/cpuinfo`, if it is one of these.
fn in_paragraph(paragraph: &str, cpus: &[usize]) -> Option<f64> {
    let value = |key: &str| {
        let mut pairs = paragraph.lines().filter_map(|line| line.split_once(':'));
        pairs.find(|(name, _)| name.trim() == key).map(|(_, value)| value.trim())
    };
    let cpu: usize = value("processor")?.parse().ok()?;
    value("cpu MHz").filter(|_| cpus.contains(&cpu))?.parse().ok()
}

fn mean(values: &[f64]) -> Option<f64> {
    let sum: f64 = values.iter().sum();
    (sum > 0.0).then(|| sum / values.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_driver_counts_before_cpuinfo() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(clock_mhz(folder.path(), &[0, 1]), None);
        fs::create_dir_all(folder.path().join("proc")).unwrap();
        let text = "processor\t: 0\ncpu MHz\t\t: 2000.000\n\nprocessor\t: 1\ncpu MHz\t\t: 3000.000\n";
        fs::write(folder.path().join("proc/cpuinfo"), text).unwrap();
        assert_eq!(clock_mhz(folder.path(), &[0, 1]), Some(2500.0));
        assert_eq!(clock_mhz(folder.path(), &[1]), Some(3000.0));
        assert_eq!(clock_mhz(folder.path(), &[7]), None);
        let driver = folder.path().join("sys/devices/system/cpu/cpu1/cpufreq");
        fs::create_dir_all(&driver).unwrap();
        fs::write(driver.join("scaling_cur_freq"), "3600000\n").unwrap();
        assert_eq!(clock_mhz(folder.path(), &[0, 1]), Some(3600.0));
    }
}

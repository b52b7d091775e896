//! The share of the processors that a control group grants, as containers have it.

use std::fs;
use std::path::Path;

/// Processors that this process may use at once by its control groups; `None` without a limit. `root` is `/`.
///
/// Version 2 writes `QUOTA PERIOD` in microseconds into `cpu.max`, version 1 into two files. Each ancestor limits its
/// descendants, so the smallest quota counts.
pub fn cpu_quota(root: &Path) -> Option<f64> {
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).ok()?;
    let quotas = groups.lines().filter_map(|line| {
        let mut parts = line.splitn(3, ':').skip(1);
        let (controllers, path) = (parts.next()?, parts.next()?.trim_start_matches('/'));
        if controllers.is_empty() {
            return smallest(&root.join("sys/fs/cgroup"), path, of_version_2);
        }
        let has_cpu = controllers.split(',').any(|controller| controller == "cpu");
        let base = root.join("sys/fs/cgroup").join(controllers);
        let base = if base.exists() { base } else { root.join("sys/fs/cgroup/cpu") };
        if has_cpu { smallest(&base, path, of_version_1) } else { None }
    });
    quotas.reduce(f64::min)
}

/// The smallest quota of a group and its ancestors.
fn smallest(base: &Path, group: &str, quota: fn(&Path) -> Option<f64>) -> Option<f64> {
    let folder = base.join(group);
    // In a container, the path may be the host's, and the container's own group lies at the base.
    let ancestors = folder.ancestors().take_while(|folder| folder.starts_with(base));
    ancestors.filter_map(quota).reduce(f64::min)
}

fn of_version_2(folder: &Path) -> Option<f64> {
    let text = fs::read_to_string(folder.join("cpu.max")).ok()?;
    let (quota, period) = text.trim().split_once(' ')?;
    share(quota, period)
}

fn of_version_1(folder: &Path) -> Option<f64> {
    let read = |name: &str| fs::read_to_string(folder.join(name)).ok();
    share(read("cpu.cfs_quota_us")?.trim(), read("cpu.cfs_period_us")?.trim())
}

fn share(quota: &str, period: &str) -> Option<f64> {
    let (quota, period): (f64, f64) = (quota.parse().ok()?, period.parse().ok()?);
    (quota > 0.0 && period > 0.0).then(|| quota / period)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    #[test]
    fn the_smallest_quota_of_all_ancestors_counts() {
        let two = with(&[
            ("proc/self/cgroup", "0::/outer/inner\n"),
            ("sys/fs/cgroup/outer/cpu.max", "150000 100000\n"),
            ("sys/fs/cgroup/outer/inner/cpu.max", "400000 100000\n"),
        ]);
        assert_eq!(cpu_quota(two.path()), Some(1.5));
        let container = with(&[("proc/self/cgroup", "0::/host/path\n"), ("sys/fs/cgroup/cpu.max", "50000 100000\n")]);
        assert_eq!(cpu_quota(container.path()), Some(0.5));
        let one = with(&[
            ("proc/self/cgroup", "4:memory:/a\n3:cpu,cpuacct:/a\n"),
            ("sys/fs/cgroup/cpu,cpuacct/a/cpu.cfs_quota_us", "300000\n"),
            ("sys/fs/cgroup/cpu,cpuacct/a/cpu.cfs_period_us", "100000\n"),
        ]);
        assert_eq!(cpu_quota(one.path()), Some(3.0));
    }

    #[test]
    fn without_a_limit_there_is_none() {
        let unlimited = with(&[("proc/self/cgroup", "0::/a\n"), ("sys/fs/cgroup/a/cpu.max", "max 100000\n")]);
        assert_eq!(cpu_quota(unlimited.path()), None);
        let old = with(&[
            ("proc/self/cgroup", "3:cpu:/\n"),
            ("sys/fs/cgroup/cpu/cpu.cfs_quota_us", "-1\n"),
            ("sys/fs/cgroup/cpu/cpu.cfs_period_us", "100000\n"),
        ]);
        assert_eq!(cpu_quota(old.path()), None);
        assert_eq!(cpu_quota(with(&[]).path()), None);
    }
}

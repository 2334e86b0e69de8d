//! The memory of the process and of the machine, in bytes, where the system tells.

use std::fs;

/// Memory that the process occupies, bytes; `None` where the system does not tell.
pub fn resident() -> Option<u64> {
    value_of(&fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")
}

/// Memory of the machine, bytes; `None` where the system does not tell.
pub fn installed() -> Option<u64> {
    value_of(&fs::read_to_string("/proc/meminfo").ok()?, "MemTotal:")
}

/// The value of a line such as `VmRSS:     1234 kB`.
fn value_of(table: &str, key: &str) -> Option<u64> {
    let line = table.lines().find_map(|line| line.strip_prefix(key))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(1024 * kibibytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_the_system_is_read() {
        let table = "Name:\tmocc\nVmRSS:\t    2048 kB\nThreads:\t2\n";
        assert_eq!(value_of(table, "VmRSS:"), Some(2 << 20));
        assert_eq!(value_of(table, "MemTotal:"), None);
        assert_eq!(value_of("VmRSS: many kB", "VmRSS:"), None);
    }
}

//! The ends of processes that run foreign code.

use std::ffi::c_int;

/// SIGKILL of POSIX.
const KILL: c_int = 9;

unsafe extern "C" {
    fn _exit(status: c_int) -> !;
    fn kill(process: c_int, signal: c_int) -> c_int;
}

/// Ends this process at once. An ordinary exit runs the destructors of the FMU, and waits for the loader while a library
/// is loaded: a hang there would never end.
pub fn end_at_once() -> ! {
    // SAFETY: it takes a number and does not return.
    unsafe { _exit(0) }
}

/// Ends the processes of a group, which are the child and what the FMU has started in it. The child must still be there
/// or not have been waited for, so that its number is not that of another process.
pub fn end_group(leader: u32) {
    let Ok(group) = c_int::try_from(leader) else { return };
    if group > 1 {
        // SAFETY: it takes two numbers. A group that has gone is no failure.
        unsafe { kill(-group, KILL) };
    }
}

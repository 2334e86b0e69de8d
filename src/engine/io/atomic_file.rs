//! Atomic files: written to a temporary sibling that is renamed at the end.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use thiserror::Error;

/// Why a file was not written; the target is unchanged.
#[derive(Error, Debug)]
pub enum WriteError {
    /// The target is a directory or a device; renaming over it would destroy it.
    #[error("cannot write {}: it is not a regular file", path.display())]
    NotAFile {
        /// The target.
        path: PathBuf,
    },
    /// No temporary file could be created next to the target.
    #[error("cannot create {}: {source}", path.display())]
    Create {
        /// The target.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// Writing failed, for example because the disk is full.
    #[error("cannot write {}: {source}", path.display())]
    Write {
        /// The target.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The finished file could not take the target's name.
    #[error("cannot replace {}: {source}", path.display())]
    Replace {
        /// The target.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
}

/// A file under construction. Dropped without [`AtomicFile::finish`] it is removed.
#[derive(Debug)]
pub struct AtomicFile {
    out: BufWriter<File>,
    temporary: Temporary,
    target: PathBuf,
}

impl AtomicFile {
    /// Starts the file at `path`. A link to a file is followed, so that it stays a link;
    /// an older file keeps its permissions.
    pub fn create(path: impl AsRef<Path>) -> Result<Self, WriteError> {
        let path = path.as_ref();
        let failed = |source| WriteError::Create { path: path.to_path_buf(), source };
        let older = match fs::metadata(path) {
            Ok(data) if data.is_file() => Some(data.permissions()),
            Ok(_) => return Err(WriteError::NotAFile { path: path.to_path_buf() }),
            Err(e) if e.kind() == io::ErrorKind::NotFound => None,
            Err(e) => return Err(failed(e)),
        };
        if path.file_name().is_none() {
            return Err(WriteError::NotAFile { path: path.to_path_buf() });
        }
        let target = match older {
            Some(_) => fs::canonicalize(path).map_err(failed)?,
            None => path.to_path_buf(),
        };
        let (file, temporary) = Temporary::beside(&target).map_err(failed)?;
        if let Some(permissions) = older {
            file.set_permissions(permissions).map_err(failed)?;
        }
        Ok(AtomicFile { out: BufWriter::with_capacity(1 << 16, file), temporary, target })
    }
    /// Gives the file its name, atomically replacing an older one.
    pub fn finish(self) -> Result<(), WriteError> {
        let AtomicFile { mut out, mut temporary, target } = self;
        if let Err(source) = out.flush() {
            return Err(WriteError::Write { path: target, source });
        }
        drop(out);
        match fs::rename(&temporary.path, &target) {
            Ok(()) => {
                temporary.renamed = true;
                Ok(())
            }
            Err(source) => Err(WriteError::Replace { path: target, source }),
        }
    }
    /// Overwrites earlier bytes at the offset `at`; subsequent writes go to the end again.
    pub fn patch(&mut self, at: u64, bytes: &[u8]) -> io::Result<()> {
        let end = self.out.stream_position()?;
        self.out.seek(SeekFrom::Start(at))?;
        self.out.write_all(bytes)?;
        self.out.seek(SeekFrom::Start(end))?;
        Ok(())
    }
    /// A write error with the name of this file.
    pub fn failed(&self, source: io::Error) -> WriteError {
        WriteError::Write { path: self.target.clone(), source }
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// Writes `bytes` to `path` atomically.
pub fn write_file(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), WriteError> {
    let mut file = AtomicFile::create(path)?;
    file.write_all(bytes).map_err(|source| file.failed(source))?;
    file.finish()
}

/// Writes texts to files of a folder, each atomically; returns their paths.
pub fn write_files(
    folder: &Path,
    files: impl IntoIterator<Item = (String, String)>,
) -> Result<Vec<PathBuf>, WriteError> {
    let one = |(name, text): (String, String)| {
        let path = folder.join(name);
        write_file(&path, text.as_bytes()).map(|()| path)
    };
    files.into_iter().map(one).collect()
}

/// A path for a file that only this process needs; the extension decides its format.
pub fn scratch_path(extension: &str) -> PathBuf {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    std::env::temp_dir().join(format!("mocc-{}-{count}.{extension}", std::process::id()))
}

/// A folder for files that all processes of this user may share.
pub fn shared_folder(name: &str) -> PathBuf {
    std::env::temp_dir().join(name)
}

/// The bytes of a file, which is removed.
pub fn take_file(path: &Path) -> io::Result<Vec<u8>> {
    let bytes = fs::read(path);
    let _ = fs::remove_file(path);
    bytes
}

/// Creates a folder for results and its parents, unless it exists.
pub fn create_folder(path: impl AsRef<Path>) -> Result<(), WriteError> {
    let path = path.as_ref();
    fs::create_dir_all(path)
        .map_err(|source| WriteError::Create { path: path.to_path_buf(), source })
}

/// The name of the temporary file; removes it when dropped before it was renamed.
#[derive(Debug)]
struct Temporary {
    path: PathBuf,
    renamed: bool,
}

impl Temporary {
    /// A new file in the directory of `target`: a rename is atomic only within one file system.
    fn beside(target: &Path) -> io::Result<(File, Temporary)> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        loop {
            let count = COUNT.fetch_add(1, Ordering::Relaxed);
            let path = target.with_file_name(format!(".mocc-{}-{count}.part", std::process::id()));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                // Left over from a killed process with the same id.
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
                Ok(file) => return Ok((file, Temporary { path, renamed: false })),
            }
        }
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.renamed {
            // A failure cannot be handled here; the name shows what the file is.
            let _ = fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// An empty directory of this name for one test, removed when dropped.
    pub(crate) struct Scratch(PathBuf);

    impl Scratch {
        pub(crate) fn new(name: &str) -> Self {
            let path = std::env::temp_dir().join(format!("mocc-{name}-{}", std::process::id()));
            let _ = fs::remove_dir_all(&path);
            fs::create_dir_all(&path).unwrap();
            Scratch(path)
        }
        pub(crate) fn path(&self, file: &str) -> PathBuf {
            self.0.join(file)
        }
        pub(crate) fn files(&self) -> Vec<String> {
            let names = fs::read_dir(&self.0).unwrap();
            let mut names: Vec<String> =
                names.map(|f| f.unwrap().file_name().into_string().unwrap()).collect();
            names.sort();
            names
        }
    }

    impl Drop for Scratch {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn a_dropped_file_leaves_nothing() {
        let dir = Scratch::new("dropped");
        let mut file = AtomicFile::create(dir.path("out.csv")).unwrap();
        file.write_all(b"half").unwrap();
        assert_eq!(dir.files().len(), 1, "the temporary file");
        drop(file);
        assert_eq!(dir.files(), [""; 0]);
    }

    #[test]
    fn a_patch_overwrites_earlier_bytes() {
        let dir = Scratch::new("patched");
        let mut file = AtomicFile::create(dir.path("out.bin")).unwrap();
        file.write_all(b"count: 0000; ").unwrap();
        file.patch(7, b"0012").unwrap();
        file.write_all(b"end").unwrap();
        file.finish().unwrap();
        assert_eq!(fs::read(dir.path("out.bin")).unwrap(), b"count: 0012; end");
    }

    #[test]
    fn an_older_file_remains_until_the_new_one_is_complete() {
        let dir = Scratch::new("older");
        let target = dir.path("out.csv");
        write_file(&target, b"older").unwrap();
        let mut file = AtomicFile::create(&target).unwrap();
        file.write_all(&[b'x'; 200_000]).unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"older");
        drop(file);
        assert_eq!(fs::read(&target).unwrap(), b"older");
        write_file(&target, b"newer").unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"newer");
        assert_eq!(dir.files(), ["out.csv"]);
    }

    #[test]
    fn directories_are_rejected_and_missing_ones_named() {
        let dir = Scratch::new("refused");
        fs::create_dir(dir.path("inner")).unwrap();
        let error = write_file(dir.path("inner"), b"").unwrap_err();
        assert!(matches!(error, WriteError::NotAFile { .. }), "{error}");
        let error = write_file(dir.path("none/out.csv"), b"").unwrap_err().to_string();
        assert!(error.starts_with("cannot create ") && error.contains("none"), "{error}");
        assert_eq!(dir.files(), ["inner"]);
    }

    #[cfg(unix)]
    #[test]
    fn links_and_permissions_survive_and_devices_are_rejected() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let dir = Scratch::new("links");
        write_file(dir.path("real"), b"1").unwrap();
        fs::set_permissions(dir.path("real"), fs::Permissions::from_mode(0o640)).unwrap();
        symlink(dir.path("real"), dir.path("link")).unwrap();
        write_file(dir.path("link"), b"2").unwrap();
        assert!(fs::symlink_metadata(dir.path("link")).unwrap().is_symlink());
        assert_eq!(fs::read(dir.path("real")).unwrap(), b"2");
        let mode = fs::metadata(dir.path("real")).unwrap().permissions().mode();
        assert_eq!(mode & 0o777, 0o640);
        assert!(matches!(AtomicFile::create("/dev/null"), Err(WriteError::NotAFile { .. })));
    }
}

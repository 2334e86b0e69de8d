//! The ZIP archive of an FMU. Sole user of `zip`.
//!
//! In: names and contents. Out: the bytes of the archive; equal contents give equal bytes.

use std::io::{Cursor, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Packs files, in this order.
pub fn pack(files: &[(String, &[u8])]) -> Result<Vec<u8>, String> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default())
        .unix_permissions(0o644);
    for (name, content) in files {
        // Loaders map libraries: they are executable.
        let options = match name.starts_with("binaries/") {
            true => options.unix_permissions(0o755),
            false => options,
        };
        writer.start_file(name.as_str(), options).map_err(|e| e.to_string())?;
        writer.write_all(content).map_err(|e| e.to_string())?;
    }
    writer.finish().map(Cursor::into_inner).map_err(|e| e.to_string())
}

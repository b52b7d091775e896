//! stub
use std::path::Path; use std::io::{self,Write};
/// stub
pub fn write(path: &Path, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> crate::error::Result<()> {
    let mut f = std::fs::File::create(path).map_err(|e| crate::error::Error::system("writing", path, e))?;
    body(&mut f).map_err(|e| crate::error::Error::system("writing", path, e))
}

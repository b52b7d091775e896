//! Paths of files as addresses: folders are named by users.

/// A path as the target of a link. Bytes with a meaning of their own in an address are percent-encoded (RFC 3986, 2.1).
pub(crate) fn href(path: &str) -> String {
    let encoded = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => char::from(byte).to_string(),
        _ => format!("%{byte:02X}"),
    };
    path.bytes().map(encoded).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn usual_paths_stay_as_they_are() {
        assert_eq!(href("../thread-scaling/records_1.csv~"), "../thread-scaling/records_1.csv~");
    }

    /// The codes are those of ASCII; ü has two bytes in UTF-8.
    #[test]
    fn bytes_that_an_address_would_read_are_encoded() {
        assert_eq!(href("a #1/50 %?ü"), "a%20%231/50%20%25%3F%C3%BC");
        assert_eq!(href("a:b(c)"), "a%3Ab%28c%29");
    }
}

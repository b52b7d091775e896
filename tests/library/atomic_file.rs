//! Atomic output files: they appear whole or not at all, and an output that cannot be written is refused beforehand.

use std::fs;
use std::io;
use std::path::Path;
use std::time::{Duration, SystemTime};

use pathmark::atomic_file::{check_writable, write};
use pathmark::error::Error;

/// Names in `directory`, sorted.
fn names(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).expect("a directory");
    let mut names: Vec<_> = entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_file_is_replaced_as_a_whole() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("out.csv");
    for text in ["first", "second, longer", ""] {
        write(&path, |out| out.write_all(text.as_bytes())).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
    }
    assert_eq!(names(directory.path()), ["out.csv"]);
}

#[test]
fn a_body_that_fails_anywhere_leaves_the_old_file() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("out.csv");
    fs::write(&path, "old").unwrap();
    for written in [0, 1, 8191, 8192, 100_000] {
        let error = write(&path, |out| {
            out.write_all(&vec![b'x'; written])?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .unwrap_err();
        assert!(matches!(&error, Error::System { action: "writing", .. }), "{error}");
        assert_eq!(error.exit_code(), 3);
        assert!(error.to_string().contains("out.csv"), "{error}");
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(directory.path()), ["out.csv"]);
    }
    let panicked = std::panic::catch_unwind(|| write(&path, |_| panic!("in the body")));
    assert!(panicked.is_err());
    assert_eq!((fs::read(&path).unwrap(), names(directory.path())), (b"old".to_vec(), vec!["out.csv".to_string()]));
}

#[test]
fn asking_leaves_nothing_behind() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("out.csv");
    check_writable("image", &path).unwrap();
    assert!(names(directory.path()).is_empty());
    fs::write(&path, "old").unwrap();
    check_writable("image", &path).unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    check_writable("image", &directory.path().join("n".repeat(255))).unwrap();
}

#[test]
fn a_name_that_can_be_no_file_is_the_users_to_mend() {
    let directory = tempfile::tempdir().unwrap();
    let root = directory.path();
    fs::write(root.join("file"), "old").unwrap();
    fs::create_dir(root.join("folder")).unwrap();
    let cases = [
        (root.join("folder"), "is a directory"),
        (root.join("file/out.csv"), "not a directory"),
        (root.join("missing/out.csv"), "does not exist"),
        (root.join("n".repeat(256)), "too long"),
        (root.join("zero\0byte"), "zero byte"),
        (root.join("out.csv/"), "not the name of a file"),
        (root.join(".."), "is a directory"),
        ("".into(), "not the name of a file"),
        ("/".into(), "not the name of a file"),
    ];
    for (path, reason) in cases {
        for (field, asked) in [("image", check_writable("image", &path)), ("file", write(&path, |_| Ok(())))] {
            let error = asked.unwrap_err();
            assert!(matches!(&error, Error::Input(input) if input.field == field), "{error}");
        }
        if !path.ends_with("..") {
            assert!(check_writable("image", &path).unwrap_err().to_string().contains(reason), "{}", path.display());
        }
    }
    assert_eq!(names(root), ["file", "folder"]);
    assert_eq!(fs::read(root.join("file")).unwrap(), b"old");
}

/// The next write into a folder removes the file of a killed writer. It keeps a living writer's file, and the file of
/// another host that may be living: where locks do not reach from host to host, only the file's age tells.
#[test]
fn the_next_writer_removes_files_of_killed_writers() {
    let directory = tempfile::tempdir().unwrap();
    let (root, at) = (directory.path(), |name: &str| directory.path().join(name));
    let another = |boot: &str| at(&format!(".pathmark-{boot}-AbCdEf.tmp"));
    for path in [another("other"), another("older"), at(".pathmark-notes.txt"), at("pathmark-1.tmp")] {
        fs::write(path, "x").unwrap();
    }
    let yesterday = SystemTime::now() - Duration::from_hours(25);
    let file = fs::File::options().write(true).open(another("older")).unwrap();
    file.set_modified(yesterday).unwrap();
    drop(file);
    // A writer in progress, which yields the name of its temporary file.
    let mut inner = Vec::new();
    write(&at("slow.csv"), |out| {
        out.write_all(b"first")?;
        inner = names(root);
        write(&at("quick.csv"), |out| out.write_all(b"x")).unwrap();
        // Like a kill: the file stays, and no process has it open.
        let own = inner.iter().find(|name| name.contains(".tmp") && !name.contains("other") && !name.starts_with('p'));
        let left = own.unwrap().replace(".tmp", "-dead.tmp");
        fs::write(at(&left), "x").unwrap();
        assert!(names(root).contains(&left));
        check_writable("image", &at("another.csv")).unwrap();
        assert!(!names(root).contains(&left), "{:?}", names(root));
        out.write_all(b", second")
    })
    .unwrap();
    assert_eq!(fs::read(at("slow.csv")).unwrap(), b"first, second");
    let expected = [".pathmark-notes.txt", ".pathmark-other-AbCdEf.tmp", "pathmark-1.tmp", "quick.csv", "slow.csv"];
    assert_eq!(names(root), expected);
}

#[test]
fn a_file_name_alone_is_written_here() {
    // Only asks: a test that changes the working directory would disturb the others.
    check_writable("image", Path::new("a-name-alone.csv")).unwrap();
}

mod unix {
    use super::{check_writable, fs, names, write};
    use std::os::unix::fs::{PermissionsExt, symlink};

    #[test]
    fn the_umask_decides_who_may_read() {
        let directory = tempfile::tempdir().unwrap();
        let (ours, plain) = (directory.path().join("ours"), directory.path().join("plain"));
        write(&ours, |out| out.write_all(b"x")).unwrap();
        fs::write(&plain, "x").unwrap();
        let mode = |path| fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(ours), mode(plain));
    }

    #[test]
    fn a_link_is_followed_and_a_loop_refused() {
        let directory = tempfile::tempdir().unwrap();
        let root = directory.path();
        fs::create_dir(root.join("far")).unwrap();
        fs::write(root.join("far/file"), "old").unwrap();
        symlink("far/file", root.join("link")).unwrap();
        write(&root.join("link"), |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(root.join("far/file")).unwrap(), b"new");
        assert!(fs::symlink_metadata(root.join("link")).unwrap().is_symlink());
        assert_eq!(names(&root.join("far")), ["file"]);
        // A link to a missing file creates that file.
        symlink("far/later", root.join("dangling")).unwrap();
        check_writable("image", &root.join("dangling")).unwrap();
        write(&root.join("dangling"), |out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read(root.join("far/later")).unwrap(), b"new");
        assert!(fs::symlink_metadata(root.join("dangling")).unwrap().is_symlink());
        symlink("nowhere/file", root.join("astray")).unwrap();
        assert_eq!(write(&root.join("astray"), |_| Ok(())).unwrap_err().exit_code(), 2);
        symlink("loop", root.join("loop")).unwrap();
        assert!(check_writable("image", &root.join("loop")).is_err());
    }

    /// Apple's file system refuses names that are not text.
    #[cfg(not(target_vendor = "apple"))]
    #[test]
    fn a_name_need_not_be_text() {
        use std::os::unix::ffi::OsStrExt;
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join(std::ffi::OsStr::from_bytes(b"out-\xff.csv"));
        check_writable("image", &path).unwrap();
        write(&path, |out| out.write_all(b"x")).unwrap();
        assert_eq!(fs::read(path).unwrap(), b"x");
    }

    /// No user, not even root, may create a file in Linux's /proc.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_refusal_of_the_system_is_told_as_one() {
        use super::{Error, Path};
        for error in
            [check_writable("image", Path::new("/proc/out.csv")), write(Path::new("/proc/out.csv"), |_| Ok(()))]
        {
            let error = error.unwrap_err();
            assert!(matches!(&error, Error::System { .. }), "{error}");
            assert!(error.to_string().starts_with("writing /proc/out.csv: "), "{error}");
        }
    }

    #[test]
    fn special_files_are_not_replaced_by_plain_files() {
        // The socket stands for /dev/null: replacing that as superuser would take it from the whole machine.
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("socket");
        let _socket = std::os::unix::net::UnixListener::bind(&path).unwrap();
        assert_eq!(check_writable("image", &path).unwrap_err().exit_code(), 2);
        assert_eq!(write(&path, |_| Ok(())).unwrap_err().exit_code(), 2);
        assert!(!fs::metadata(&path).unwrap().is_file());
    }
}

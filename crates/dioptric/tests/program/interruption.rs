// SPDX-License-Identifier: MIT OR Apache-2.0
//! Readers that go away, and Ctrl-C.

use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use super::run::{Folder, finish, program, scene};

#[test]
fn a_reader_that_goes_away_is_no_fault() {
    let materials = scene("materials.star");
    for args in [
        vec!["why", &materials, "0,0,64,48", "--json"],
        vec!["why", &materials, "0,0,64,48"],
        vec!["list"],
    ] {
        let mut child =
            program(&args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let mut reader = BufReader::new(child.stdout.take().unwrap());
        reader.read_line(&mut String::new()).unwrap();
        drop(reader);
        let ran = finish(child.wait_with_output().unwrap());
        assert_eq!((ran.status, ran.stderr.as_str()), (0, ""), "{args:?}");
    }
}

#[test]
#[cfg(unix)]
fn ctrl_c_saves_the_picture_so_far_and_says_so() {
    let folder = Folder::new("interrupt");
    let (materials, out) = (scene("materials.star"), folder.file("out.png"));
    // Hours of work; on a busy machine the program may need a while to begin it.
    let args = [
        "render",
        &materials,
        "--antialias",
        "sobol",
        "--samples",
        "65536",
        "--size",
        "640x480",
        "-o",
        &out,
    ];
    for wait in [2, 8, 30] {
        let child = program(&args).stderr(Stdio::piped()).spawn().unwrap();
        sleep(Duration::from_secs(wait));
        let sent = Command::new("kill").arg("-INT").arg(child.id().to_string()).status().unwrap();
        assert!(sent.success());
        let ran = finish(child.wait_with_output().unwrap());
        assert_eq!(ran.status, 130, "{}", ran.stderr);
        if !ran.stderr.contains("unfinished") {
            // It had not begun to render: nothing to save, and nothing left behind.
            assert!(folder.names().is_empty(), "{:?}", folder.names());
            continue;
        }
        assert!(ran.stderr.contains("out.png: unfinished, stopped at "), "{}", ran.stderr);
        let bytes = folder.bytes("out.png");
        let says = |text: &[u8]| bytes.windows(text.len()).any(|w| w == text);
        assert!(says(b"Unfinished") && says(b"stopped at "));
        assert_eq!(folder.picture("out.png").width(), 640);
        assert_eq!(folder.names(), ["out.png"]);
        return;
    }
    panic!("the program never began to render");
}

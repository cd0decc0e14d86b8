// SPDX-License-Identifier: MIT OR Apache-2.0
//! Every crate that the program is built from has a licence that `deny.toml` allows. `cargo deny check`
//! says more, but is a program of its own; this needs cargo alone.

#![cfg(feature = "cli")]

use std::path::Path;
use std::process::Command;

fn output(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).output().expect("the program starts");
    assert!(output.status.success(), "{program}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).expect("UTF-8")
}

/// The quoted words between `allow = [` and `]`.
fn allowed(deny: &str) -> Vec<&str> {
    let list =
        deny.split("allow = [").nth(1).and_then(|rest| rest.split(']').next()).expect("a list");
    list.split('"').skip(1).step_by(2).collect()
}

/// Whether one of the alternatives of an SPDX expression is allowed in all its parts.
fn is_allowed(expression: &str, allowed: &[&str]) -> bool {
    let plain = expression.replace('/', " OR ").replace(['(', ')'], "");
    // Parentheses only ever group alternatives here: (A OR B) AND C needs C and one of A and B.
    plain
        .split(" AND ")
        .all(|part| part.split(" OR ").any(|licence| allowed.contains(&licence.trim())))
}

#[test]
fn all_dependencies_have_permissive_licences() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let deny = std::fs::read_to_string(root.join("deny.toml")).expect("deny.toml");
    let allowed = allowed(&deny);
    assert!(allowed.contains(&"MIT"));

    // Only what this machine builds: crates for others may not have been fetched.
    let version = output("rustc", &["-vV"]);
    let host = version.lines().find_map(|line| line.strip_prefix("host: ")).expect("a host");
    let manifest = root.join("Cargo.toml");
    let metadata = output(
        env!("CARGO"),
        &[
            "metadata",
            "--offline",
            "--format-version",
            "1",
            "--filter-platform",
            host,
            "--manifest-path",
        ]
        .into_iter()
        .chain(manifest.to_str())
        .collect::<Vec<_>>(),
    );
    let metadata: serde_json::Value = serde_json::from_str(&metadata).expect("JSON");
    let packages = metadata["packages"].as_array().expect("packages");
    let refused: Vec<String> = packages
        .iter()
        .filter(|package| !package["license"].as_str().is_some_and(|l| is_allowed(l, &allowed)))
        .map(|package| format!("{} ({})", package["name"], package["license"]))
        .collect();
    println!("{} crates, all with licences that deny.toml allows", packages.len());
    assert!(refused.is_empty(), "{refused:#?}");
}

#[test]
fn expressions_are_read_as_alternatives() {
    let allowed = ["MIT", "Apache-2.0", "Unicode-3.0"];
    assert!(is_allowed("MIT OR Apache-2.0", &allowed) && is_allowed("MIT/Apache-2.0", &allowed));
    assert!(is_allowed("(MIT OR Apache-2.0) AND Unicode-3.0", &allowed));
    assert!(is_allowed("GPL-3.0 OR MIT", &allowed));
    assert!(!is_allowed("AGPL-3.0", &allowed) && !is_allowed("MIT AND GPL-3.0", &allowed));
}

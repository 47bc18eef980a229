//! Folders that Python's packages lie in, found without running a Python.
//!
//! ```text
//! folders that this process's own Python imports from, where a program is its module
//! packages of the active environment: VIRTUAL_ENV, CONDA_PREFIX
//! packages of the `python3` and the `python` that the PATH has first: beside it, and where its links lead;
//!     where a version manager stands in for it, packages of all versions that it has
//! packages of the user, which `pip install --user` installs
//! ```

use std::env;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Folders that this process's Python imports from.
static IMPORTED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Has packages also be looked for in these folders, and there first: for programs that are modules of a Python, those that it
/// imports from.
pub fn import_packages_from(folders: Vec<PathBuf>) {
    *IMPORTED.lock().unwrap_or_else(PoisonError::into_inner) = folders;
}

/// Folders of packages, in the order in which they are to be searched. They need not exist.
pub(crate) fn package_folders() -> Vec<PathBuf> {
    // A browser has no packages, and no paths to split
    if cfg!(target_family = "wasm") {
        return Vec::new();
    }
    let imported = IMPORTED.lock().unwrap_or_else(PoisonError::into_inner).clone();
    folders_of(imported, |name| env::var_os(name).filter(|value| !value.is_empty()))
}

fn folders_of(imported: Vec<PathBuf>, variable: impl Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let active = ["VIRTUAL_ENV", "CONDA_PREFIX"].into_iter().filter_map(&variable).map(PathBuf::from);
    let prefixes = active.chain(prefixes_on_path(&variable("PATH").unwrap_or_default()));
    let mut folders = imported;
    folders.extend(prefixes.flat_map(|prefix| packages_of(&prefix)));
    folders.extend(user_packages(&variable));
    // What a relative path means changes with the folder that a command is run in
    folders.retain(|folder| folder.is_absolute());
    let mut different: Vec<PathBuf> = Vec::new();
    for folder in folders {
        if !different.contains(&folder) {
            different.push(folder);
        }
    }
    different
}

/// Prefixes of the first interpreters on the PATH: where a link lies, which is an environment's, and where it leads; or those
/// that a version manager would choose from.
fn prefixes_on_path(path: &OsString) -> Vec<PathBuf> {
    let folders: Vec<PathBuf> = env::split_paths(path).collect();
    let first = |name: &str| {
        let name = format!("{name}{}", env::consts::EXE_SUFFIX);
        folders.iter().map(|folder| folder.join(&name)).find(|file| file.is_file())
    };
    let interpreters = ["python3", "python"].into_iter().filter_map(first);
    let places = interpreters.flat_map(|file| [Some(file.clone()), fs::canonicalize(&file).ok()]).flatten();
    places.flat_map(|file| prefixes_of(&file)).collect()
}

/// The folder that an interpreter was installed into. A shim has those of all versions: pyenv's, and asdf's or mise's.
fn prefixes_of(interpreter: &Path) -> Vec<PathBuf> {
    let Some(folder) = interpreter.parent() else { return Vec::new() };
    let above = folder.parent().unwrap_or(folder);
    if folder.ends_with("shims") {
        let versions = ["versions", "installs/python"].map(|name| above.join(name));
        return versions.iter().flat_map(|versions| newest_first(versions, "3.")).collect();
    }
    let is_inner = ["bin", "Scripts"].iter().any(|name| folder.ends_with(name));
    vec![if is_inner { above } else { folder }.to_owned()]
}

/// Folders of packages below a prefix, of the newest Python first.
fn packages_of(prefix: &Path) -> Vec<PathBuf> {
    if cfg!(target_os = "windows") {
        return vec![prefix.join("Lib").join("site-packages")];
    }
    // Debian's own Python has other names, and installs into local
    let libraries = ["lib", "local/lib"].map(|name| prefix.join(name));
    let folders = libraries.iter().flat_map(|library| newest_first(library, "python3"));
    folders.flat_map(|folder| ["site-packages", "dist-packages"].map(|name| folder.join(name))).collect()
}

fn user_packages(variable: &impl Fn(&str) -> Option<OsString>) -> Vec<PathBuf> {
    let at = |name: &str, inner: &str| variable(name).map(|folder| Path::new(&folder).join(inner));
    let mut folders: Vec<PathBuf> =
        at("PYTHONUSERBASE", "").into_iter().flat_map(|base| packages_of(&base)).collect();
    if cfg!(target_os = "windows") {
        let versions = at("APPDATA", "Python").map(|folder| newest_first(&folder, "Python3"));
        folders.extend(versions.unwrap_or_default().iter().map(|folder| folder.join("site-packages")));
        return folders;
    }
    if cfg!(target_os = "macos") {
        let versions = at("HOME", "Library/Python").map(|folder| newest_first(&folder, "3."));
        folders.extend(versions.unwrap_or_default().iter().map(|it| it.join("lib/python/site-packages")));
    }
    folders.extend(at("HOME", ".local").into_iter().flat_map(|base| packages_of(&base)));
    folders
}

/// Folders of a folder whose names begin so, those of the greatest versions first.
fn newest_first(folder: &Path, beginning: &str) -> Vec<PathBuf> {
    let version = |name: &str| {
        let rest = name.strip_prefix(beginning)?;
        // Some installations end in a t, which has threads
        let rest = rest.trim_start_matches('.').trim_end_matches('t');
        // 11 and 11.7 are read, and nothing, as in python3
        let digits = rest.split('.').next()?;
        if digits.is_empty() { Some(0) } else { digits.parse::<u32>().ok() }
    };
    let names = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.file_name());
    let mut found: Vec<_> = names.filter_map(|name| Some((version(name.to_str()?)?, name))).collect();
    found.sort_by(|a, b| b.cmp(a));
    found.into_iter().map(|(_, name)| folder.join(name)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Folders of packages where these variables are set and no others.
    fn with(variables: &[(&str, &Path)], imported: &[&Path]) -> Vec<PathBuf> {
        let value = |name: &str| {
            variables.iter().find(|(key, _)| *key == name).map(|(_, path)| path.as_os_str().to_owned())
        };
        folders_of(imported.iter().map(|path| (*path).to_owned()).collect(), value)
    }

    #[test]
    fn package_folders_follow_no_relative_path() {
        let here = Path::new("python");
        assert_eq!(
            with(&[("VIRTUAL_ENV", here), ("PATH", here), ("HOME", here)], &[Path::new("")]),
            Vec::<PathBuf>::new()
        );
    }

    #[test]
    #[cfg(unix)]
    fn package_folders_are_those_of_environments_then_interpreters_then_the_user() {
        let folder = tempfile::tempdir().unwrap();
        let root = fs::canonicalize(folder.path()).unwrap();
        let make = |path: &str| fs::create_dir_all(root.join(path)).unwrap();
        for path in ["env/lib/python3.9", "env/lib/python3.12", "env/lib/pythonic", "conda/lib/python3.11"] {
            make(path);
        }
        for path in ["linked/bin", "linked/lib/python3.10", "system/bin", "system/local/lib/python3.13"] {
            make(path);
        }
        make("home/.local/lib/python3.8");
        for path in
            ["pyenv/shims", "pyenv/versions/3.9.1/lib/python3.9", "pyenv/versions/3.11.7/lib/python3.11"]
        {
            make(path);
        }
        fs::write(root.join("pyenv/shims/python"), b"").unwrap();
        make("imported");
        fs::write(root.join("system/bin/python3.13"), b"").unwrap();
        std::os::unix::fs::symlink("../../system/bin/python3.13", root.join("linked/bin/python3")).unwrap();
        let at = |path: &str| root.join(path);
        let found = with(
            &[
                ("VIRTUAL_ENV", &at("env")),
                ("CONDA_PREFIX", &at("conda")),
                ("PATH", Path::new(&env::join_paths([at("linked/bin"), at("pyenv/shims")]).unwrap())),
                ("HOME", &at("home")),
            ],
            &[&at("imported"), &at("env/lib/python3.12/site-packages")],
        );
        let names: Vec<&Path> = found.iter().map(|path| path.strip_prefix(&root).unwrap()).collect();
        let expected = [
            "imported",
            "env/lib/python3.12/site-packages",
            "env/lib/python3.12/dist-packages",
            "env/lib/python3.9/site-packages",
            "env/lib/python3.9/dist-packages",
            "conda/lib/python3.11/site-packages",
            "conda/lib/python3.11/dist-packages",
            "linked/lib/python3.10/site-packages",
            "linked/lib/python3.10/dist-packages",
            "system/local/lib/python3.13/site-packages",
            "system/local/lib/python3.13/dist-packages",
            "pyenv/versions/3.11.7/lib/python3.11/site-packages",
            "pyenv/versions/3.11.7/lib/python3.11/dist-packages",
            "pyenv/versions/3.9.1/lib/python3.9/site-packages",
            "pyenv/versions/3.9.1/lib/python3.9/dist-packages",
            "home/.local/lib/python3.8/site-packages",
            "home/.local/lib/python3.8/dist-packages",
        ];
        assert_eq!(names, expected.map(Path::new));
    }
}

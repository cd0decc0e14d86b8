// SPDX-License-Identifier: MIT OR Apache-2.0
//! Intel Open Image Denoise, version 2, loaded when it is wanted.
//!
//! Its C interface: <https://www.openimagedenoise.org/documentation.html>. Light is given as it is (`hdr`), on the
//! processor. How its results round may differ between machines.

use std::ffi::{CStr, c_char, c_int, c_void};
use std::path::{Path, PathBuf};

use libloading::Library;

use crate::Picture;

/// The names by which the system finds it.
const NAMES: &[&str] = if cfg!(target_os = "windows") {
    &["OpenImageDenoise.dll"]
} else if cfg!(target_os = "macos") {
    &["libOpenImageDenoise.2.dylib", "libOpenImageDenoise.dylib"]
} else {
    &["libOpenImageDenoise.so.2", "libOpenImageDenoise.so"]
};

/// Three f32 a pixel (`OIDN_FORMAT_FLOAT3`).
const FLOAT3: c_int = 3;

/// The processor (`OIDN_DEVICE_TYPE_CPU`).
const CPU: c_int = 1;

type Handle = *mut c_void;
type NewDevice = unsafe extern "C" fn(c_int) -> Handle;
type OnHandle = unsafe extern "C" fn(Handle);
type GetError = unsafe extern "C" fn(Handle, *mut *const c_char) -> c_int;
type NewFilter = unsafe extern "C" fn(Handle, *const c_char) -> Handle;
type SetInt = unsafe extern "C" fn(Handle, *const c_char, c_int);
type SetBool = unsafe extern "C" fn(Handle, *const c_char, bool);
type SetImage = unsafe extern "C" fn(
    Handle,
    *const c_char,
    *mut c_void,
    c_int,
    usize,
    usize,
    usize,
    usize,
    usize,
);

/// The library, loaded.
#[derive(Debug)]
pub struct Oidn {
    library: Library,
}

impl Oidn {
    /// Loads the library from a file, from a folder that has it, or else from where the system looks.
    ///
    /// # Errors
    /// It is not there or cannot be loaded: the reason.
    pub fn load(place: Option<&Path>) -> Result<Self, String> {
        let candidates: Vec<PathBuf> = match place {
            None => NAMES.iter().map(PathBuf::from).collect(),
            Some(folder) if folder.is_dir() => NAMES.iter().map(|name| folder.join(name)).collect(),
            Some(file) => vec![file.to_path_buf()],
        };
        let mut reason = String::new();
        for candidate in candidates {
            // SAFETY: loading runs the library's initialisers. The user named it, or the system keeps it under the name of
            // a library that is made to be loaded so.
            match unsafe { Library::new(&candidate) } {
                Ok(library) => return Ok(Self { library }),
                Err(error) if reason.is_empty() => reason = error.to_string(),
                Err(_) => {}
            }
        }
        Err(reason)
    }

    /// The picture without its noise, by so many threads.
    ///
    /// # Errors
    /// The library says what is wrong, or is of another kind.
    pub fn denoise(&self, picture: &Picture<'_>, threads: usize) -> Result<Vec<[f32; 3]>, String> {
        if !picture.is_whole() {
            return Err("the picture's layers are not of one size".into());
        }
        // SAFETY: the types are those of version 2's header, and each function is called below as its documentation
        // says. The symbols do not outlive the library, which `self` holds.
        unsafe {
            let new_device = *self.symbol::<NewDevice>(b"oidnNewDevice\0")?;
            let set_device_int = *self.symbol::<SetInt>(b"oidnSetDeviceInt\0")?;
            let commit_device = *self.symbol::<OnHandle>(b"oidnCommitDevice\0")?;
            let get_error = *self.symbol::<GetError>(b"oidnGetDeviceError\0")?;
            let release_device = *self.symbol::<OnHandle>(b"oidnReleaseDevice\0")?;
            let new_filter = *self.symbol::<NewFilter>(b"oidnNewFilter\0")?;
            let set_image = *self.symbol::<SetImage>(b"oidnSetSharedFilterImage\0")?;
            let set_bool = *self.symbol::<SetBool>(b"oidnSetFilterBool\0")?;
            let commit_filter = *self.symbol::<OnHandle>(b"oidnCommitFilter\0")?;
            let execute = *self.symbol::<OnHandle>(b"oidnExecuteFilter\0")?;
            let release_filter = *self.symbol::<OnHandle>(b"oidnReleaseFilter\0")?;

            let error_of = |device: Handle| {
                let mut text: *const c_char = std::ptr::null();
                // SAFETY: the text is a string that ends in 0 and lives until the next call for this device (or thread).
                let code = get_error(device, &mut text);
                if code == 0 {
                    Ok(())
                } else if text.is_null() {
                    Err(format!("error {code}"))
                } else {
                    Err(CStr::from_ptr(text).to_string_lossy().into_owned())
                }
            };
            let device = new_device(CPU);
            if device.is_null() {
                error_of(device)?;
                return Err("it has no device for processors".into());
            }
            set_device_int(device, c"numThreads".as_ptr(), c_int::try_from(threads).unwrap_or(0));
            commit_device(device);
            let mut output = vec![[0.0f32; 3]; picture.color.len()];
            let mut done = error_of(device);
            if done.is_ok() {
                let filter = new_filter(device, c"RT".as_ptr());
                let (width, height) = (picture.width, picture.height);
                // SAFETY: each image has width * height * 3 floats (`is_whole`) and lives until the filter is
                // released. Inputs are only read, although the interface asks for pointers that could be written to.
                let image = |name: &CStr, data: *mut c_void| {
                    set_image(filter, name.as_ptr(), data, FLOAT3, width, height, 0, 0, 0);
                };
                image(c"color", picture.color.as_ptr().cast_mut().cast());
                image(c"albedo", picture.albedo.as_ptr().cast_mut().cast());
                image(c"normal", picture.normal.as_ptr().cast_mut().cast());
                image(c"output", output.as_mut_ptr().cast());
                set_bool(filter, c"hdr".as_ptr(), true);
                commit_filter(filter);
                execute(filter);
                done = error_of(device);
                release_filter(filter);
            }
            release_device(device);
            done.map(|()| output)
        }
    }

    /// A function of the library.
    ///
    /// # Safety
    /// `T` is its type.
    unsafe fn symbol<T>(&self, name: &[u8]) -> Result<libloading::Symbol<'_, T>, String> {
        // SAFETY: the caller's promise.
        unsafe { self.library.get(name) }
            .map_err(|_| "it is not version 2 of Open Image Denoise".to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_library_is_an_error() {
        let here = Path::new(env!("CARGO_MANIFEST_DIR"));
        for place in [here.join("Cargo.toml"), here.join("none.so"), here.join("src")] {
            assert!(!Oidn::load(Some(&place)).unwrap_err().is_empty());
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn another_library_is_an_error() {
        let libc = Oidn::load(Some(Path::new("libc.so.6"))).unwrap();
        let one = [[0.5; 3]];
        let picture =
            Picture { width: 1, height: 1, color: &one, albedo: &one, normal: &one, depth: &[1.0] };
        assert!(libc.denoise(&picture, 1).unwrap_err().contains("version 2"));
    }
}

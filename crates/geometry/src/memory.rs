// SPDX-License-Identifier: MIT OR Apache-2.0
//! Large arrays in large pages: a ray that jumps about in 100 MB otherwise waits for the page tables as often
//! as for the numbers.

/// An empty vector with room for `capacity` things, in large pages where it is large and the system has them.
pub(crate) fn with_capacity<T>(capacity: usize) -> Vec<T> {
    let vector = Vec::with_capacity(capacity);
    advise(&vector);
    vector
}

/// Below this many bytes there is nothing to gain.
#[cfg(target_os = "linux")]
const LARGE: usize = 4 << 20;

/// Asks for large pages for a vector that nothing was written to yet, where it is large.
#[cfg(target_os = "linux")]
pub fn advise<T>(vector: &Vec<T>) {
    const PAGE: usize = 4096;
    let (start, bytes) = (vector.as_ptr() as usize, vector.capacity() * size_of::<T>());
    if bytes < LARGE {
        return;
    }
    let (first, end) = (start.next_multiple_of(PAGE), (start + bytes) / PAGE * PAGE);
    // SAFETY: the pages lie within the vector's own memory, and the advice changes nothing in it. Where it is
    // refused, nothing is lost.
    unsafe {
        libc::madvise(first as *mut libc::c_void, end - first, libc::MADV_HUGEPAGE);
    }
}

/// There are no large pages to ask for.
#[cfg(not(target_os = "linux"))]
pub fn advise<T>(_: &Vec<T>) {}

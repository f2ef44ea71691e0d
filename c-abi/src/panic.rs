//! Where a panic would lead. None is left in a release: the function that it would call does not exist, and the linker
//! of the image says so.

#[cfg(all(target_os = "none", debug_assertions))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

#[cfg(all(target_os = "none", not(debug_assertions)))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn a_panic_is_left_in_the_release_image() -> !;
    }
    // SAFETY: never called: an image in which it could be does not link.
    unsafe { a_panic_is_left_in_the_release_image() }
}

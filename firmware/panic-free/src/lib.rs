//! What real time calls in each number format, exported, over a panic handler and a heap that call functions which do not
//! exist: steps on compiled pieces, planned and given, and on the global parameter, the begin of a stretch, a setpoint's
//! position.
//!
//! The linker drops what no export can reach. If a panic can be reached from a step, so can the handler, and then its
//! function is missing and nothing is linked; so with the heap. `scripts/no-panic` builds this once as it is and once with
//! an unwrap in it.

#![no_std]

use nurbs_core::NurbsCurve;
use secant_interp::{
    FeedOverride, Interpolator, OverrideState, PieceInterpolator, PieceSetpoint, PieceState, Setpoint, State,
    Stretch,
};

unsafe extern "C" {
    fn the_heap_can_be_reached_from_a_real_time_step() -> !;
    fn a_panic_can_be_reached_from_a_real_time_step() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: there is no such function. Nothing that calls it is ever linked.
    unsafe { a_panic_can_be_reached_from_a_real_time_step() }
}

/// A heap that does not exist.
struct NoHeap;

// SAFETY: there are no such functions. Nothing that calls them is ever linked.
unsafe impl core::alloc::GlobalAlloc for NoHeap {
    unsafe fn alloc(&self, _: core::alloc::Layout) -> *mut u8 {
        // SAFETY: as above.
        unsafe { the_heap_can_be_reached_from_a_real_time_step() }
    }

    unsafe fn dealloc(&self, _: *mut u8, _: core::alloc::Layout) {
        // SAFETY: as above.
        unsafe { the_heap_can_be_reached_from_a_real_time_step() }
    }
}

#[global_allocator]
static HEAP: NoHeap = NoHeap;

/// What a step was asked to write, or nothing at the end.
fn give<T>(place: &mut T, value: Option<T>) -> bool {
    value.map(|value| *place = value).is_some()
}

macro_rules! steps {
    ($($module:ident: $format:ty, $dimensions:literal;)*) => {$(
        /// The calls in one format and space.
        pub mod $module {
            use super::*;

            /// A period on compiled pieces.
            #[unsafe(export_name = concat!("pieces_", stringify!($module)))]
            pub fn on_pieces(
                interpolator: &PieceInterpolator<'_, $format, $dimensions>,
                state: &mut PieceState<$format, $dimensions>,
                setpoint: &mut PieceSetpoint<$format, $dimensions>,
            ) -> bool {
                give(setpoint, interpolator.step(state))
            }

            /// Where a stretch begins, after a stop.
            #[unsafe(export_name = concat!("stretch_", stringify!($module)))]
            pub fn at_a_stop<'a>(
                path: &PieceInterpolator<'a, $format, $dimensions>,
                stretch: &Stretch,
                run: &mut PieceInterpolator<'a, $format, $dimensions>,
                state: &mut PieceState<$format, $dimensions>,
            ) {
                *run = path.on(stretch);
                *state = run.start();
            }

            /// A setpoint in whole units.
            #[unsafe(export_name = concat!("position_", stringify!($module)))]
            pub fn position(
                run: &PieceInterpolator<'_, $format, $dimensions>,
                setpoint: &PieceSetpoint<$format, $dimensions>,
            ) -> [i64; $dimensions] {
                run.pieces.position(setpoint.piece, &setpoint.offset)
            }

            /// The step with the plan's time stretched.
            #[unsafe(export_name = concat!("overridden_", stringify!($module)))]
            pub fn overridden(
                interpolator: &PieceInterpolator<'_, $format, $dimensions>,
                state: &mut PieceState<$format, $dimensions>,
                feeds: &FeedOverride,
                rates: &mut OverrideState,
                setpoint: &mut PieceSetpoint<$format, $dimensions>,
            ) -> bool {
                give(setpoint, interpolator.step_overridden(state, feeds, rates))
            }

            /// A chord that does not come from the schedule.
            #[unsafe(export_name = concat!("given_", stringify!($module)))]
            pub fn given(
                interpolator: &PieceInterpolator<'_, $format, $dimensions>,
                state: &mut PieceState<$format, $dimensions>,
                length: $format,
                setpoint: &mut PieceSetpoint<$format, $dimensions>,
            ) -> bool {
                give(setpoint, interpolator.step_by(state, length))
            }

            /// A period on the global parameter.
            #[unsafe(export_name = concat!("raw_", stringify!($module)))]
            pub fn on_curve<'a>(
                interpolator: &Interpolator<'a, $format, NurbsCurve<'a, $format, $dimensions>>,
                state: &mut State<$format, $dimensions>,
                setpoint: &mut Setpoint<$format, $dimensions>,
            ) -> bool {
                give(setpoint, interpolator.step(state))
            }
        }
    )*};
}

steps! {
    f64_plane: f64, 2;
    f64_space: f64, 3;
    f32_plane: f32, 2;
    f32_space: f32, 3;
    i16f16_plane: real::I16F16, 2;
    i8f24_plane: real::I8F24, 2;
    i4f28_plane: real::I4F28, 2;
    i4f28_space: real::I4F28, 3;
    i3f29_plane: real::I3F29, 2;
    i2f30_plane: real::I2F30, 2;
    i32f32_plane: real::I32F32, 2;
    i16f48_plane: real::I16F48, 2;
    i4f60_plane: real::I4F60, 2;
}

/// What must not link.
#[cfg(feature = "an-unwrap")]
#[unsafe(export_name = "pieces_with_an_unwrap")]
pub fn with_an_unwrap(
    interpolator: &PieceInterpolator<'_, f64, 2>,
    state: &mut PieceState<f64, 2>,
) -> PieceSetpoint<f64, 2> {
    interpolator.step(state).unwrap()
}

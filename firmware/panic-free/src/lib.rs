//! What real time calls in each number format, exported, over a panic handler that calls a function which does not exist:
//! steps on compiled pieces, planned and given, and on the global parameter, the begin of a section, a setpoint's position, and
//! all of a run whose constants `feedbits compile` wrote.
//!
//! The linker drops what no export can reach. If a panic can be reached from a step, so can the handler, and then its
//! function is missing and nothing is linked. There is no heap to be reached: the kernels are without their feature `alloc`, and
//! no allocator is named, without which nothing that knows of the heap is linked. `scripts/no-panic` builds this once as it is,
//! once with an unwrap in it and once with `alloc`.

#![no_std]

use nurbs_core::NurbsCurve;
use secant_interp::{
    FeedOverride, Interpolator, OverrideState, PieceInterpolator, PieceSetpoint, PieceState,
    PositionChecksum, Section, Setpoint, State,
};

unsafe extern "C" {
    fn a_panic_can_be_reached_from_a_real_time_step() -> !;
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    // SAFETY: there is no such function. Nothing that calls it is ever linked.
    unsafe { a_panic_can_be_reached_from_a_real_time_step() }
}

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

            /// Where a section begins, after a stop.
            #[unsafe(export_name = concat!("stretch_", stringify!($module)))]
            pub fn at_a_stop<'a>(
                path: &PieceInterpolator<'a, $format, $dimensions>,
                section: &Section,
                run: &mut PieceInterpolator<'a, $format, $dimensions>,
                state: &mut PieceState<$format, $dimensions>,
            ) {
                *run = path.on(section);
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

/// A part of three sections in I4F28.
#[allow(unreachable_pub, reason = "it is written for any program")]
mod stairs {
    include!("../../../tests/tests/constants/stairs_i4f28.rs");
}

/// The checksum of the run that the constants of a part make.
#[unsafe(export_name = "compiled_run")]
pub fn compiled() -> u64 {
    let mut checksum = PositionChecksum::default();
    for section in &stairs::SECTIONS {
        let run = stairs::PATH.on(section);
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset));
        }
    }
    checksum.value()
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

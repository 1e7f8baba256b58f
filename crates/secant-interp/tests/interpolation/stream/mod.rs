//! Streams: what is read from one is what was written, or is refused before its first setpoint.

mod layout;
mod overridden;
mod refused;
mod setpoints;
mod streamed;

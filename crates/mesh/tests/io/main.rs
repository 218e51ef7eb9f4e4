//! Reading and writing, through the public interface.

mod broken;
mod common;
mod damage;
mod oracle;
mod round_trip;

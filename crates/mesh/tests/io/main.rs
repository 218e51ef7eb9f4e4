//! Reading and writing, through the public interface.

mod broken;
mod common;
mod damage;
mod gltf;
mod kept_obj;
mod oracle;
mod round_trip;

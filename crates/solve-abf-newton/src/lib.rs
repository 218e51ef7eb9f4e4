//! Newton solvers with a direct inner solve: ABF, ABF++, Newton, fixed target

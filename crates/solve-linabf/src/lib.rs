//! Linear angle-based flattening (Zayer, Lévy, Seidel 2007)

//! MINRES on the Schur complement (Zayer, Rössl, Seidel 2004)

//! Conjugate-direction Uzawa (Zayer, Rössl, Seidel 2004)

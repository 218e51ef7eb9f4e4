//! The energies of a surface.

use super::energy::{AngleEnergy, Density, Isometric, Slider, SymmetricDirichlet};
use super::rest::rest_shapes;
use super::settings::{Energy, Relax};
use super::terms::{Spring, Terms};
use crate::objective::Objective;
use abf_constraints::AngleProblem;
use abf_mesh::{Topology, TriMesh};
use std::sync::Arc;

/// The energies of a surface.
pub(crate) struct Energies<'p, 'a> {
    /// The one that is asked for, or the symmetric Dirichlet energy where that is the energy of ABF.
    pub(crate) isometric: Isometric,
    angles: AngleEnergy<'p, 'a>,
    energy: Energy,
}

impl<'p, 'a> Energies<'p, 'a> {
    pub(crate) fn new(relax: &Relax, mesh: &TriMesh, problem: &'p AngleProblem<'a>) -> Self {
        let density: Arc<dyn Density> = match relax.energy {
            Energy::Slider(theta) => Arc::new(Slider { theta }),
            Energy::Abf | Energy::Isometric => Arc::new(SymmetricDirichlet),
        };
        let angles = AngleEnergy { objective: Objective { problem, barrier: relax.barrier } };
        Self { isometric: Isometric { density, rest: rest_shapes(mesh) }, angles, energy: relax.energy }
    }

    /// What a drawing costs with the energy that is asked for, and with springs.
    pub(crate) fn terms<'t>(&'t self, topology: &'t Topology, springs: &'t [Spring]) -> Terms<'t> {
        match self.energy {
            Energy::Abf => Terms { topology, triangles: &self.angles, springs, barrier: None },
            Energy::Isometric | Energy::Slider(_) => {
                Terms { topology, triangles: &self.isometric, springs, barrier: None }
            }
        }
    }
}

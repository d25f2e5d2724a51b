#pragma once

/// Everything that a simulator usually needs, under one namespace. Rooms keep their own headers for the rest.
#include "filasofia/core/error.h"
#include "filasofia/core/units.h"
#include "filasofia/event/input_events.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/runtime/assets.h"
#include "filasofia/runtime/simulation.h"

#include <algorithm>
#include <cstdio>

namespace filasofia {

namespace shapes = geometry::shapes;

using event::Event;
using event::EventType;
using event::KeyCode;
using event::KeyEvent;
using event::MouseButtonEvent;
using event::MouseMoveEvent;
using event::MouseWheelEvent;
using event::PhysicsUpdateEvent;
using event::TextInputEvent;
using event::VisualUpdateEvent;
using event::WindowEvent;
using frame::FrameRef;
using geometry::Box;
using geometry::TetMesh;
using geometry::TriangleMesh;
using physics::AttachmentDef;
using physics::AttachMode;
using physics::Ball;
using physics::Cholesky;
using physics::CollisionDef;
using physics::ConjugateGradient;
using physics::Density;
using physics::ExactContact;
using physics::ExplicitEuler;
using physics::FemMaterial;
using physics::GivenInertia;
using physics::GraspDef;
using physics::ImplicitEuler;
using physics::kHard;
using physics::MassSpringMaterial;
using physics::NodalForce;
using physics::PenaltyContact;
using physics::Rayleigh;
using physics::RigidAttachmentDef;
using physics::RigidBodyDef;
using physics::SoftBodyDef;
using physics::TetMeshSource;
using physics::TotalMass;
using runtime::asset;
using runtime::ContactEvent;
using runtime::LookDef;
using runtime::PhysicsDef;
using runtime::report;
using runtime::RunDef;
using runtime::RunReport;
using runtime::ShowDef;
using runtime::Simulation;
using runtime::SimulationDef;
using visual::Backend;
using visual::CanvasDef;
using visual::Color;
using visual::DebugStyle;
using visual::GuiDef;
using visual::MetalMaterial;
using visual::TissueMaterial;

} // namespace filasofia

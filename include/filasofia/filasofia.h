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
using physics::LoosePiece;
using physics::MassSpringMaterial;
using physics::NodalForce;
using physics::PenaltyContact;
using physics::Rayleigh;
using physics::RigidAttachmentDef;
using physics::RigidBodyDef;
using physics::Rupture;
using physics::SoftBodyDef;
using physics::TetMeshSource;
using physics::TotalMass;
using runtime::asset;
using runtime::ContactEvent;
using runtime::CutEvent;
using runtime::FollowDef;
using runtime::FollowElement;
using runtime::FollowNearest;
using runtime::FollowTriangle;
using runtime::LookDef;
using runtime::PaintDef;
using runtime::PaintMode;
using runtime::PhysicsDef;
using runtime::report;
using runtime::RunDef;
using runtime::RunReport;
using runtime::ShowDef;
using runtime::ShownId;
using runtime::Simulation;
using runtime::SimulationDef;
using runtime::TearEvent;
using visual::addEndoscopeLook;
using visual::Backend;
using visual::BoneMaterial;
using visual::Camera;
using visual::CameraDef;
using visual::CanvasDef;
using visual::Color;
using visual::CustomMaterial;
using visual::DebugStyle;
using visual::EndoscopeLook;
using visual::EndoscopeOptics;
using visual::EnvironmentDef;
using visual::GlassMaterial;
using visual::GuiDef;
using visual::LightDef;
using visual::lookAt;
using visual::Material;
using visual::MetalMaterial;
using visual::MucosaMaterial;
using visual::NamedMaterial;
using visual::Quality;
using visual::SpotLight;
using visual::SurfaceState;
using visual::TextureFile;
using visual::TissueMaterial;
using visual::UnlitMaterial;
using visual::ViewDef;
using visual::Viewport;
using visual::VisualServer;

} // namespace filasofia

#pragma once

#include "filasofia/runtime/bindings.h"

#include "filasofia/engine/native_engine.h"
#include "filasofia/geometry/shapes.h"
#include "filasofia/physics/physics_engine.h"
#include "filasofia/physics/physics_server.h"
#include "filasofia/visual/null_backend.h"
#include "filasofia/visual/scene.h"
#include "filasofia/visual/visual_server.h"

namespace filasofia::runtime {

/// A physics server without gravity, a null visual server and the bindings between them; a block and a box.
struct ShownStage {
    explicit ShownStage(MeshWorker::Prepare prepare = prepareMesh) : bindings(std::move(prepare))
    {
        physics.setGravity({});
    }

    physics::PhysicsServer physics{engine::makeNativeEngine()};
    visual::VisualServer visual{{.backend = visual::Backend::Null}};
    Bindings bindings;

    /// 4 x 6 x 8 cm in cells of 2 cm.
    static std::shared_ptr<const geometry::TetMesh> mesh()
    {
        static const auto block = geometry::shapes::block({0.04, 0.06, 0.08}, {2, 3, 4});
        return block;
    }
    BodyId addBlock(const Pose& pose = {})
    {
        return physics.add(physics::SoftBodyDef{.name = "block", .mesh = mesh(), .pose = pose});
    }
    BodyId addBox(std::vector<Pose> elements = {Pose{}})
    {
        return physics.add(physics::RigidBodyDef{.name = "box",
                                                 .elements = std::move(elements),
                                                 .mesh = geometry::shapes::box({0.02, 0.02, 0.02}, {4, 4, 4})});
    }
    void map()
    {
        bindings.addPending(visual);
        if (const auto frame = physics.latest()) bindings.update(*frame, physics, visual);
        visual.render(); // visibility is passed on with a picture
    }
    void step()
    {
        physics.step(1e-3);
        map();
    }
    /// All bodies in the null backend, in the order in which they came.
    std::vector<const visual::NullBackend::Body*> drawn() { return drawn(visual); }
    static std::vector<const visual::NullBackend::Body*> drawn(visual::VisualServer& server)
    {
        visual::Camera& door = server.add(visual::CameraDef{}); // any entity gives access to the backend
        const auto& backend = dynamic_cast<const visual::NullBackend&>(*door.impl().scene.backend);
        server.remove(door);
        std::vector<const visual::NullBackend::Body*> all;
        for (const auto& [slot, each] : backend.bodies) all.push_back(&each);
        return all;
    }
    const visual::NullBackend::Body& only()
    {
        const auto all = drawn();
        REQUIRE(all.size() == 1);
        return *all.front();
    }
};

} // namespace filasofia::runtime

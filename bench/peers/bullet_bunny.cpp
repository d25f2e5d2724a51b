#include "bench/peers/bullet_bunny.h"

#include "filasofia/math/polar.h"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <chrono>

namespace filasofia::peers {
namespace {

using Vectors = btAlignedObjectArray<btVector3>;

constexpr bool kSingle = sizeof(btScalar) == sizeof(float);

/// Bullet's solver with access to its settings, which are protected members without setters.
class TunedSolver : public btDeformableBodySolver {
public:
    explicit TunedSolver(const BulletSetting& def) : fill_(def.massPreconditioner)
    {
        if (def.newtonIterations > 0) m_maxNewtonIterations = def.newtonIterations;
        if (def.tolerance > 0.0) m_cg.m_tolerance = static_cast<btScalar>(def.tolerance);
        if (def.maxIterations > 0) m_cg.m_maxIterations = def.maxIterations;
    }
    // Called at each step. Bullet 3.24 selects the mass preconditioner but never fills it, so it acts as the identity.
    void setPreconditioner(int which) override
    {
        btDeformableBodySolver::setPreconditioner(which);
        if (fill_) m_objective->m_massPreconditioner->reinitialize(true);
        fill_ = false;
    }

private:
    bool fill_ = false;
};

/// Bullet's elasticity. Counts matrix products and, if asked, uses the rotations that our equations have.
class Elasticity : public btDeformableLinearElasticityForce {
public:
    Elasticity(const Problem& problem, bool rotationsOfStepStart)
        : btDeformableLinearElasticityForce(1, 1, static_cast<btScalar>(problem.rayleighMass),
                                            static_cast<btScalar>(problem.rayleighStiffness)),
          ours_(rotationsOfStepStart)
    {
        setPoissonRatio(static_cast<btScalar>(kPoissonRatio));
        setYoungsModulus(static_cast<btScalar>(kYoungModulus));
    }
    [[nodiscard]] long products() const { return products_; }

    void reinitialize(bool nodeUpdated) override
    {
        btDeformableLinearElasticityForce::reinitialize(nodeUpdated);
        stepBegins_ = true;
    }
    void addScaledForces(btScalar scale, Vectors& force) override
    {
        if (ours_) turnElements();
        btDeformableLinearElasticityForce::addScaledForces(scale, force);
    }
    void addScaledDampingForceDifferential(btScalar scale, const Vectors& dv, Vectors& df) override
    {
        ++products_;
        btDeformableLinearElasticityForce::addScaledDampingForceDifferential(scale, dv, df);
    }

private:
    // Bullet extracts rotations at the predicted positions and stops at 0.01 rad, which is a model of its own. With the
    // rotations of the positions at the start of the step, found once per step from those of the last step, its
    // equations are ours. Our own function finds them: Bullet's converges slowly and took a tenth of its step.
    void turnElements()
    {
        btSoftBody& body = *m_softBodies[0];
        rotations_.resize(static_cast<std::size_t>(body.m_tetras.size()));
        for (int element = 0; element < body.m_tetras.size(); ++element) {
            Quat& rotation = rotations_[static_cast<std::size_t>(element)];
            if (stepBegins_) rotation = polarRotation(deformationAtStart(body.m_tetras[element]), rotation);
            body.m_tetraScratches[element].m_corotation =
                btMatrix3x3({static_cast<btScalar>(rotation.x), static_cast<btScalar>(rotation.y),
                             static_cast<btScalar>(rotation.z), static_cast<btScalar>(rotation.w)});
        }
        stepBegins_ = false;
    }
    static Mat3 deformationAtStart(const btSoftBody::Tetra& tetra)
    {
        const btVector3& a = tetra.m_n[0]->m_x;
        const btVector3 b = tetra.m_n[1]->m_x - a, c = tetra.m_n[2]->m_x - a, d = tetra.m_n[3]->m_x - a;
        const btMatrix3x3 f =
            btMatrix3x3(b.x(), c.x(), d.x(), b.y(), c.y(), d.y(), b.z(), c.z(), d.z()) * tetra.m_Dm_inverse;
        return {{{f[0].x(), f[0].y(), f[0].z()}, {f[1].x(), f[1].y(), f[1].z()}, {f[2].x(), f[2].y(), f[2].z()}}};
    }

    bool ours_;
    bool stepBegins_ = true;
    long products_ = 0;
    std::vector<Quat> rotations_;
};

std::unique_ptr<btSoftBody> makeBody(btSoftBodyWorldInfo& world, const Problem& problem)
{
    Vectors nodes;
    for (const Vec3& node : problem.mesh->nodes)
        nodes.push_back(
            btVector3(static_cast<btScalar>(node.x), static_cast<btScalar>(node.y), static_cast<btScalar>(node.z)));
    auto body = std::make_unique<btSoftBody>(&world, nodes.size(), &nodes[0], nullptr);
    const std::vector<double> masses = lumpedMasses(problem);
    for (int node = 0; node < nodes.size(); ++node)
        body->setMass(node, static_cast<btScalar>(masses[static_cast<std::size_t>(node)])); // 0 for a pinned node
    // Without faces: there is nothing to collide with, and Bullet then keeps no normals and no face tree up to date.
    for (const geometry::Tetrahedron& t : problem.mesh->tetrahedra) body->appendTetra(t[0], t[1], t[2], t[3]);
    body->initializeDmInverse();
    body->m_tetraScratches.resize(body->m_tetras.size());
    body->m_tetraScratchesTn.resize(body->m_tetras.size());
    body->m_cfg.collisions = 0;
    body->setActivationState(DISABLE_DEACTIVATION);
    return body;
}

} // namespace

const char* bulletPrecision() { return kSingle ? "single" : "double"; }

double bulletVersion() { return btGetVersion() / 100.0; }

Run runBullet(const Problem& problem, const BulletSetting& def)
{
    using Clock = std::chrono::steady_clock;
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher(&configuration);
    btDbvtBroadphase broadphase;
    TunedSolver solver(def);
    btDeformableMultiBodyConstraintSolver constraints;
    constraints.setDeformableSolver(&solver);
    btDeformableMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &constraints, &configuration, &solver);
    world.setImplicit(def.implicitElasticity);
    world.setUseProjection(true); // the alternative, Lagrange multipliers, has no implicit elasticity in Bullet 3.24
    const btVector3 gravity(0, static_cast<btScalar>(-kGravity), 0);
    btDeformableGravityForce weight(gravity);
    Elasticity elasticity(problem, def.rotationsOfStepStart);
    const std::unique_ptr<btSoftBody> body = makeBody(world.getWorldInfo(), problem);
    world.addSoftBody(body.get());
    world.addForce(body.get(), &weight);
    world.addForce(body.get(), &elasticity);

    Run run;
    for (int step = 0; step < problem.steps; ++step) {
        const Clock::time_point before = Clock::now();
        world.stepSimulation(static_cast<btScalar>(problem.dt), 0); // 0: one step of exactly this length
        run.seconds.push_back(std::chrono::duration<double>(Clock::now() - before).count());
    }
    run.iterations = static_cast<double>(elasticity.products()) / problem.steps;
    for (int node = 0; node < body->m_nodes.size(); ++node) {
        const btVector3& x = body->m_nodes[node].m_x;
        run.positions.push_back({x.x(), x.y(), x.z()});
    }
    world.removeSoftBody(body.get());
    return run;
}

} // namespace filasofia::peers

#include "filasofia/engine/native_engine.h"
#include "filasofia/linalg/node_kernels.h"

#include "verification/bunny.h"

namespace determinism_test {

using namespace filasofia;
using namespace filasofia::engine;
using namespace filasofia::physics;

namespace {

/// Uses one instruction set until the end of its scope.
struct Target {
    explicit Target(const std::string& name) { linalg::useSimdTarget(name); }
    ~Target() { linalg::useSimdTarget(""); }
};

/// Instruction sets with fused multiply-add; all of them compute the same bits.
bool fused(const std::string& target) { return target == "AVX3" || target == "AVX2" || target == "NEON"; }

std::uint64_t hashAfter(int elements, int threads, int steps, double dt, const Solver& solver = ConjugateGradient{},
                        const ElasticLaw& law = NeoHookean{})
{
    Stage stage = standingBunny(elements, solver, threads, law);
    stage.run(steps, dt);
    return stage.world.hash();
}

} // namespace

TEST_CASE("two runs of every bunny have the same hash at every step")
{
    for (int elements : {756, 1492, 3004}) {
        Stage a = standingBunny(elements, ConjugateGradient{}), b = standingBunny(elements, ConjugateGradient{});
        for (int i = 0; i < 50; ++i) {
            a.step(0.005);
            b.step(0.005);
            REQUIRE(a.world.hash() == b.world.hash());
        }
        std::cout << "verification: bunny " << elements << " after 50 steps, hash: " << std::hex << a.world.hash()
                  << std::dec << " (bound: two runs equal)\n";
    }
}

TEST_CASE("1, 2, 3 and 8 threads make the same hash")
{
    for (const Solver& solver : {Solver{ConjugateGradient{}}, Solver{ConjugateGradient{.assembled = true}}})
        for (int elements : {756, 3004}) { // one thread computes the small one, all threads share the large one
            const std::uint64_t one = hashAfter(elements, 1, 30, 0.005, solver);
            for (int threads : {2, 3, 8}) CHECK(hashAfter(elements, threads, 30, 0.005, solver) == one);
        }
    CHECK(hashAfter(10000, 1, 10, 0.001) == hashAfter(10000, 3, 10, 0.001));
    for (int threads : {2, 3, 8}) {
        Stage small = standingBunny(756, ConjugateGradient{}, threads);
        Stage large = standingBunny(3004, ConjugateGradient{}, threads);
        small.step(0.0);
        large.step(0.0);
        CHECK_FALSE(threadsShare(small, threads));
        CHECK(threadsShare(large, threads));
    }
}

TEST_CASE("1, 2, 3 and 8 threads make the same hash of bodies that threads share and bodies that they divide up")
{
    const auto hashWith = [](int threads) {
        Stage stage = standingBunny(3004, ConjugateGradient{}, threads);
        for (int i = 0; i < 4; ++i) {
            SoftBodyDef def{.mesh = bunnyFile(756), .pose = {{0.3 * (i + 1), 0, 0}, {}}};
            def.attachments = {{.box = geometry::Box{{-1, -1, -1}, {2, 0.05, 1}}}};
            stage.add(def);
        }
        stage.run(30, 0.002);
        const bool isShared = threadsShare(stage, threads, 0), isDivided = !threadsShare(stage, threads, 1);
        CHECK(((isShared && isDivided) || threads < 3)); // two threads divide up all bodies
        return stage.world.hash();
    };
    const std::uint64_t one = hashWith(1);
    for (int threads : {2, 3, 8}) CHECK(hashWith(threads) == one);
}

TEST_CASE("every instruction set with fused multiply-add makes the same hash, others come close")
{
    Stage best = standingBunny(1492, ConjugateGradient{});
    best.run(50, 0.001);
    if (!fused(linalg::simdTarget()))
        WARN("no fused multiply-add on this machine: no two instruction sets compute the same bits here");
    for (const std::string& name : simdTargets()) {
        const Target target(name);
        Stage stage = standingBunny(1492, ConjugateGradient{});
        stage.run(50, 0.001);
        if (fused(name)) CHECK(stage.world.hash() == best.world.hash());
        verify(text("bunny 1492 after 50 steps of 1 ms on ", name, ", relative to displacement"),
               relativeDistance(stage.soft().x, best.soft().x, displacement(best)), fused(name) ? 0.0 : 1e-4);
    }
}

// No contraction, no -ffast-math, and a fixed order of sums: with fused multiply-add, every compiler on every machine
// computes these bits. If you change the engine's arithmetic or the content of a hash, copy the new hashes from the
// output of  test_verification "after 50 steps*"  and say so in CHANGELOG.md, because recorded hashes change for users
// too.
TEST_CASE("after 50 steps of 1 ms every bunny has the hash that it had on any machine")
{
    const std::tuple<int, std::uint64_t, std::uint64_t> goldens[] = {{756, 0x7125e6c65a6d47b0, 0x3060d74f92e68b61},
                                                                     {1492, 0x51392fcd32a1572a, 0x760b3a76612fb2a0},
                                                                     {3004, 0xc4c65c6ca15f647b, 0x39a6a8219b2e3ce2}};
    const bool same = fused(linalg::simdTarget());
    if (!same) WARN("no fused multiply-add on this machine: the default solver's hashes are not checked");
    for (const auto& [elements, inFloat, inDouble] : goldens) {
        const std::uint64_t fast = hashAfter(elements, 1, 50, 0.001);
        if (elements == 3004) CHECK(hashAfter(elements, 3, 50, 0.001) == fast); // threads share it
        const std::uint64_t reference = hashAfter(elements, 1, 50, 0.001, ConjugateGradient{.assembled = true});
        std::cout << "verification: bunny " << elements << " after 50 steps of 1 ms, hashes: {" << elements << std::hex
                  << ", 0x" << fast << ", 0x" << reference << std::dec << "} (bound: as ever)\n";
        if (same) CHECK(fast == inFloat);
        CHECK(reference == inDouble);
    }
}

TEST_CASE("a corotational bunny has the hash that it had on any machine")
{
    const ElasticLaw law = Corotational{};
    if (fused(linalg::simdTarget()))
        CHECK(hashAfter(756, 1, 50, 0.001, ConjugateGradient{}, law) == 0x41a0bc87836ea726);
    CHECK(hashAfter(756, 1, 50, 0.001, ConjugateGradient{.assembled = true}, law) == 0xa185c6649d73720e);
}

TEST_CASE("every law: 1, 2, 3 and 8 threads make the same hash")
{
    for (const NamedLaw& each : everyLaw()) {
        INFO(each.name);
        const std::uint64_t one = hashAfter(3004, 1, 20, 0.005, ConjugateGradient{}, each.law);
        for (int threads : {2, 3, 8}) CHECK(hashAfter(3004, threads, 20, 0.005, ConjugateGradient{}, each.law) == one);
    }
}

} // namespace determinism_test

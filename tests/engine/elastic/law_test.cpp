#include "filasofia/engine/elastic/law.h"

#include "filasofia/engine/body/law_range.h"
#include "filasofia/math/svd.h"

#include "engine/elastic/laws.h"
#include "engine/meshes.h"

#include <Eigen/Dense>

namespace law_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
const Lame kMaterial = lame(3000, 0.4);

/// The 9 x 9 matrix of a linear map of 3 x 3 matrices.
template <class Map> Matrix9 matrixOf(Map&& map)
{
    Matrix9 m;
    for (int c = 0; c < 9; ++c) {
        Mat3 unit;
        unit[c / 3][c % 3] = 1.0;
        const Mat3 image = map(unit);
        for (int r = 0; r < 9; ++r) m(r, c) = image[r / 3][r % 3];
    }
    return m;
}

Matrix9 tangentOf(const physics::ElasticLaw& law, const Mat3& f, double turning = 1.0)
{
    const ElementTangent tangent = tangentAt(law, kMaterial, deformation(f), turning);
    return matrixOf([&](const Mat3& df) { return stressChange(tangent, df); });
}

Matrix9 differences(const physics::ElasticLaw& law, const Mat3& f)
{
    constexpr double h = 1e-6;
    return matrixOf([&](const Mat3& unit) {
        return 0.5 / h *
               (stressAt(law, kMaterial, deformation(f + h * unit)) -
                stressAt(law, kMaterial, deformation(f - h * unit)));
    });
}

double lowestOf(const Matrix9& m)
{
    return Eigen::SelfAdjointEigenSolver<Matrix9>(0.5 * (m + m.transpose())).eigenvalues()[0];
}

/// Deformations of all kinds, but none so near to flat that the nearest rotation jumps, or that an energy has a kink.
std::vector<Mat3> deformations()
{
    std::mt19937 random(1);
    std::vector<Mat3> all;
    while (all.size() < 300) {
        const Mat3 turn = toMat3(randomRotation(random)), any = randomMat3(random, 1.0);
        const Mat3 f = all.size() % 3 == 0   ? turn * (Mat3::identity() + 0.5 * any)
                       : all.size() % 3 == 1 ? turn * (1.5 * Mat3::identity() + 0.2 * any)
                                             : 1.5 * any;
        const Mat3 s = transposeTimes(deformation(f).rotation, f);
        if (determinant(trace(s) * Mat3::identity() - s) < 0.3 || std::abs(determinant(f)) < 0.05) continue;
        all.push_back(f);
    }
    return all;
}

} // namespace

TEST_CASE("every law: the stress is the gradient of the energy, also in inverted elements")
{
    for (const auto& [name, law] : everyLaw()) {
        INFO(name);
        double worst = 0.0;
        for (const Mat3& f : deformations()) {
            constexpr double h = 1e-5;
            Mat3 slope;
            for (int k = 0; k < 9; ++k) {
                Mat3 more = f, less = f;
                more[k / 3][k % 3] += h;
                less[k / 3][k % 3] -= h;
                slope[k / 3][k % 3] = (energyDensity(law, kMaterial, deformation(more)) -
                                       energyDensity(law, kMaterial, deformation(less))) /
                                      (2 * h);
            }
            const Mat3 stress = stressAt(law, kMaterial, deformation(f));
            worst = std::max(worst, frobeniusNorm(stress - slope) / (frobeniusNorm(slope) + kMaterial.mu));
        }
        CHECK(worst < 2e-6);
    }
}

TEST_CASE("every law: at rest there is no stress, and the tangent is Hooke's, wherever the element has turned")
{
    std::mt19937 random(2);
    const Mat3 r = toMat3(randomRotation(random));
    const Matrix9 hooke = matrixOf([&](const Mat3& df) {
        const Mat3 h = transposeTimes(r, df);
        return r * (kMaterial.mu * (h + transpose(h)) + kMaterial.lambda * trace(h) * Mat3::identity());
    });
    for (const auto& [name, law] : everyLaw()) {
        INFO(name);
        CHECK(frobeniusNorm(stressAt(law, kMaterial, deformation(r))) < 1e-10);
        CHECK(energyDensity(law, kMaterial, deformation(r)) == Approx(0.0).margin(1e-10));
        CHECK((tangentOf(law, r) - hooke).norm() < 1e-9 * hooke.norm());
        CHECK((differences(law, r) - hooke).norm() < 1e-6 * hooke.norm());
    }
}

TEST_CASE("every law is objective and isotropic: turned, the element resists as much, in the turned direction")
{
    std::mt19937 random(3);
    for (const auto& [name, law] : everyLaw()) {
        INFO(name);
        for (const Mat3& f : deformations()) {
            const Mat3 r = toMat3(randomRotation(random)), q = toMat3(randomRotation(random));
            const Mat3 stress = stressAt(law, kMaterial, deformation(f));
            const Mat3 turned = stressAt(law, kMaterial, deformation(r * f * transpose(q)));
            const double size = frobeniusNorm(stress) + kMaterial.mu;
            CHECK(frobeniusNorm(turned - r * stress * transpose(q)) < 1e-9 * size);
        }
    }
}

TEST_CASE("every law: the tangent is symmetric, positive semi-definite, and in tension not below the exact one")
{
    for (const auto& [name, law] : everyLaw()) {
        INFO(name);
        int tense = 0;
        for (const Mat3& f : deformations()) {
            for (const double turning : {0.0, 0.4, 1.0}) {
                const Matrix9 tangent = tangentOf(law, f, turning);
                CHECK((tangent - tangent.transpose()).norm() < 1e-9 * tangent.norm());
                CHECK(lowestOf(tangent) > -1e-9 * tangent.norm());
            }
            const Matrix9 tangent = tangentOf(law, f), exact = differences(law, f);
            const Vec3 s = svd(f).sigma;
            const double least = 1.2; // J - 1 is above kTense
            if (!(s.z > least && s.x < 1.8)) continue;
            ++tense;
            CHECK(lowestOf(tangent - exact) > -1e-5 * (tangent.norm() + exact.norm()));
        }
        CHECK(tense > 20);
    }
}

TEST_CASE("every law: the blocks between nodes are those of the change of stress")
{
    std::mt19937 random(5);
    for (const auto& [name, law] : everyLaw()) {
        INFO(name);
        for (int k = 0; k < 20; ++k) {
            const ElementTangent tangent =
                tangentAt(law, kMaterial, deformation(Mat3::identity() + randomMat3(random, 0.8)), 0.6);
            const Vec3 gi = randomVec3(random, 1.0), gj = randomVec3(random, 1.0), dx = randomVec3(random, 1.0);
            const Vec3 expected = stressChange(tangent, outer(dx, gj)) * gi;
            CHECK(length(stiffnessBlock(tangent, gi, gj) * dx - expected) < 1e-9 * length(expected));
        }
    }
}

TEST_CASE("the laws with forms of their own agree with their response to the principal stretches")
{
    for (const physics::ElasticLaw& law : {physics::ElasticLaw(physics::NeoHookean{}), {physics::Corotational{}}})
        for (const Mat3& f : deformations()) {
            const Deformation at = deformation(f);
            const Mat3 stress = stressAt(law, kMaterial, at);
            CHECK(frobeniusNorm(stretchStress(law, kMaterial, at) - stress) < 1e-9 * frobeniusNorm(stress));
            CHECK(stretchEnergy(law, kMaterial, at) == Approx(energyDensity(law, kMaterial, at)).epsilon(1e-9));
        }
}

TEST_CASE("every law: flat, shrunk to a point, inside out and far stretched elements have finite stress and tangent")
{
    std::mt19937 random(6);
    const Mat3 r = toMat3(randomRotation(random)), q = toMat3(randomRotation(random));
    for (const auto& [name, law] : everyLaw()) {
        INFO(name);
        for (const Vec3 s : {Vec3{0, 0, 0},
                             {1, 1, 0},
                             {1, 0, 0},
                             {1, 1, -1},
                             {1, 0.5, -0.5},
                             {2, 1e-9, -1e-9},
                             {10, 10, 10},
                             {30, 0.1, 0.1},
                             {10, 0.1, -5}}) {
            const Deformation at = deformation(r * Mat3::diagonal(s) * q);
            const Mat3 stress = stressAt(law, kMaterial, at);
            for (int i = 0; i < 3; ++i) CHECK(isFinite(stress[i]));
            CHECK(tangentOf(law, at.f).allFinite());
            CHECK(std::isfinite(energyDensity(law, kMaterial, at)));
        }
    }
}

TEST_CASE("every law: stretches within its safe strain are within its range, and no larger strain is safe")
{
    std::mt19937 random(8);
    const auto i1 = [](Vec3 s) { return lengthSquared(s) / std::pow(s.x * s.y * s.z, 2.0 / 3.0); };
    int limited = 0;
    for (const auto& [name, law] : everyLaw()) {
        INFO(name);
        const double range = physics::rangeOf(law), safe = safeStrain(law);
        CHECK(std::isfinite(safe) == std::isfinite(range));
        if (!std::isfinite(range)) continue;
        ++limited;
        double most = 0.0;
        for (int i = 0; i < 1000; ++i) most = std::max(most, i1(Vec3{1, 1, 1} + randomVec3(random, safe)) - 3.0);
        for (const Vec3 corner : {Vec3{1, -1, -1}, {1, 1, -1}})
            most = std::max(most, i1(Vec3{1, 1, 1} + safe * corner) - 3.0);
        CHECK(most < range);
        CHECK(most > 0.999 * range);
        const Vec3 corner = Vec3{1, 1, 1} + 0.9 * safe * Vec3{1, -1, -1};
        const Mat3 f = toMat3(randomRotation(random)) * Mat3::diagonal(corner);
        CHECK(cubedInvariant(f) == Approx(std::pow(i1(corner), 3)));
    }
    CHECK(limited >= 2);
}

TEST_CASE("Cauchy's stress rotates with the body, is force over current area, and is zero in crushed elements")
{
    const double stretch = 1.2;
    const auto [mu, lambda] = kMaterial;
    const Mat3 f = Mat3::diagonal({stretch, 1, 1});
    const Mat3 sigma = cauchyStress(physics::Corotational{}, kMaterial, deformation(f));
    // On a unit cube: force on the face at x over its area, which the stretch leaves at 1.
    CHECK(sigma[0].x == Approx((2 * mu + lambda) * 0.2));
    CHECK(sigma[1].y == Approx(lambda * 0.2 / stretch)); // the faces at y have grown
    std::mt19937 random(7);
    for (const auto& [name, law] : everyLaw()) {
        INFO(name);
        for (int i = 0; i < 20; ++i) {
            const Mat3 r = toMat3(randomRotation(random)), g = f + randomMat3(random, 0.2);
            const Mat3 turned = cauchyStress(law, kMaterial, deformation(r * g));
            const Mat3 expected = r * cauchyStress(law, kMaterial, deformation(g)) * transpose(r);
            CHECK(frobeniusNorm(turned - expected) < 1e-9 * (frobeniusNorm(expected) + mu));
        }
        CHECK(cauchyStress(law, kMaterial, deformation(Mat3::diagonal({1, 1, -0.5}))) == Mat3{});
    }
}

} // namespace law_test

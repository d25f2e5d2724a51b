#include "filasofia/engine/elastic/membrane.h"

#include "filasofia/engine/elastic/law.h"

#include "engine/meshes.h"

namespace membrane_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

/// A triangle with legs of random length and direction.
struct Sample {
    TriangleCorners rest;
    MembraneElement element;
};

Sample randomTriangle(std::mt19937& random, double poissonRatio)
{
    Sample sample;
    do
        for (Vec3& each : sample.rest) each = randomVec3(random, 1.0);
    while (length(cross(sample.rest[1] - sample.rest[0], sample.rest[2] - sample.rest[0])) < 0.3);
    sample.element = membraneOn({0, 1, 2}, sample.rest);
    sample.element.shear = membraneShear(5.0, poissonRatio, 0.3);
    sample.element.poissonRatio = poissonRatio;
    return sample;
}

/// The triangle stretched by two factors along axes of its plane, and turned.
TriangleCorners stretched(const Sample& sample, std::mt19937& random, double first, double second)
{
    const Vec3 normal = normalized(cross(sample.rest[1] - sample.rest[0], sample.rest[2] - sample.rest[0]));
    const Vec3 axis = normalized(cross(normal, randomVec3(random, 1.0))), across = cross(normal, axis);
    const Quat turn = randomRotation(random);
    TriangleCorners x = sample.rest;
    for (Vec3& each : x) {
        const Vec3 e = each - sample.rest[0];
        each = rotate(turn, first * dot(e, axis) * axis + second * dot(e, across) * across) + Vec3{1, 2, 3};
    }
    return x;
}

Vec3 numericForce(const MembraneElement& element, const TriangleCorners& x, std::size_t node)
{
    constexpr double step = 1e-6;
    Vec3 force;
    for (int i = 0; i < 3; ++i) {
        TriangleCorners low = x, high = x;
        low[node][i] -= step;
        high[node][i] += step;
        force[i] = -(membraneEnergy(element, high) - membraneEnergy(element, low)) / (2.0 * step);
    }
    return force;
}

/// K p from differences of the forces.
TriangleCorners numericProduct(const MembraneElement& element, const TriangleCorners& x, const TriangleCorners& p)
{
    constexpr double step = 1e-6;
    TriangleCorners low = x, high = x;
    for (std::size_t k = 0; k < 3; ++k) {
        low[k] -= step * p[k];
        high[k] += step * p[k];
    }
    const TriangleCorners a = membraneForces(element, low), b = membraneForces(element, high);
    TriangleCorners product;
    for (std::size_t k = 0; k < 3; ++k) product[k] = -1.0 / (2.0 * step) * (b[k] - a[k]);
    return product;
}

double work(const TriangleCorners& a, const TriangleCorners& b)
{
    return dot(a[0], b[0]) + dot(a[1], b[1]) + dot(a[2], b[2]);
}

TriangleCorners randomMotion(std::mt19937& random)
{
    return {randomVec3(random, 1.0), randomVec3(random, 1.0), randomVec3(random, 1.0)};
}

const std::array kPoisson{0.0, 0.3, 0.45, 0.499};

} // namespace

TEST_CASE("a membrane at rest, also moved and turned, bears no force and holds no energy")
{
    std::mt19937 random(1);
    for (double nu : kPoisson) {
        const Sample sample = randomTriangle(random, nu);
        const TriangleCorners x = stretched(sample, random, 1.0, 1.0);
        CHECK(std::abs(membraneEnergy(sample.element, x)) < 1e-13);
        for (const Vec3& force : membraneForces(sample.element, x)) CHECK(length(force) < 1e-12);
    }
}

TEST_CASE("a membrane's force is minus the gradient of its energy, also crushed and drawn out")
{
    std::mt19937 random(2);
    for (int k = 0; k < 200; ++k) {
        const Sample sample = randomTriangle(random, kPoisson[static_cast<std::size_t>(k) % 4]);
        const double low = k % 5 == 0 ? 0.05 : 0.6;
        std::uniform_real_distribution<double> stretch(low, 3.0);
        const TriangleCorners x = stretched(sample, random, stretch(random), stretch(random));
        const TriangleCorners forces = membraneForces(sample.element, x);
        const double size = sample.element.shear + length(forces[0]) + length(forces[1]) + length(forces[2]);
        for (std::size_t i = 0; i < 3; ++i)
            CHECK(distance(forces[i], numericForce(sample.element, x, i)) < 1e-5 * size);
    }
}

TEST_CASE("a membrane's tangent is the exact one in tension, and never below it")
{
    std::mt19937 random(3);
    for (int k = 0; k < 200; ++k) {
        const Sample sample = randomTriangle(random, kPoisson[static_cast<std::size_t>(k) % 4]);
        const bool taut = k % 2 == 0;
        std::uniform_real_distribution<double> stretch(taut ? 1.2 : 0.3, taut ? 1.4 : 1.5);
        const double first = stretch(random), second = stretch(random);
        const TriangleCorners x = stretched(sample, random, first, second);
        const MembraneTangent tangent = membraneTangent(sample.element, x);
        const TriangleCorners p = randomMotion(random);
        const TriangleCorners product = stiffnessTimes(tangent, p), exact = numericProduct(sample.element, x, p);
        const double size = 20.0 * sample.element.shear;
        CHECK(work(p, product) >= -1e-9 * size);
        CHECK(work(p, product) >= work(p, exact) - 1e-5 * size);
        if (taut)
            for (std::size_t i = 0; i < 3; ++i) CHECK(distance(product[i], exact[i]) < 1e-5 * size);
        for (int i = 0; i < 3; ++i) { // the blocks say the same, and the matrix is symmetric
            Vec3 row;
            for (int j = 0; j < 3; ++j) {
                row += stiffnessBlock(tangent, i, j) * p[static_cast<std::size_t>(j)];
                CHECK(frobeniusNorm(stiffnessBlock(tangent, i, j) - transpose(stiffnessBlock(tangent, j, i))) <
                      1e-12 * size);
            }
            CHECK(distance(row, product[static_cast<std::size_t>(i)]) < 1e-11 * size);
        }
    }
}

TEST_CASE("without the geometric stiffness, a stretched membrane turns freely")
{
    std::mt19937 random(4);
    const Sample sample = randomTriangle(random, 0.45);
    const TriangleCorners x = stretched(sample, random, 1.3, 1.1);
    const Vec3 spin = randomVec3(random, 1.0);
    TriangleCorners turning;
    for (std::size_t i = 0; i < 3; ++i) turning[i] = cross(spin, x[i]);
    double free = 0.0, stiff = 0.0;
    for (const Vec3& each : stiffnessTimes(membraneTangent(sample.element, x, 0.0), turning)) free += length(each);
    for (const Vec3& each : stiffnessTimes(membraneTangent(sample.element, x, 1.0), turning)) stiff += length(each);
    CHECK(stiff > 0.1 * sample.element.shear);
    // What is left is half of the twist and half of the flip: both act on a turn of an unequally stretched sheet.
    CHECK(free < stiff);
}

TEST_CASE("a membrane is tissue of Smith's neo-Hookean law whose thickness is free")
{
    std::mt19937 random(5);
    for (double nu : {0.0, 0.3, 0.45}) {
        const Sample sample = randomTriangle(random, nu);
        const Lame material = lame(5.0, nu);
        for (int k = 0; k < 10; ++k) {
            std::uniform_real_distribution<double> stretch(0.8, 2.0);
            const double a = stretch(random), b = stretch(random);
            double least = 1e9;
            for (double s = 0.05; s < 3.0; s += 1e-4) {
                const double j = a * b * s;
                least = std::min(least, 0.5 * material.mu * (a * a + b * b + s * s - 3.0) - material.mu * (j - 1.0) +
                                            0.5 * (material.mu + material.lambda) * (j - 1.0) * (j - 1.0));
            }
            const double energy = membraneEnergy(sample.element, stretched(sample, random, a, b));
            CHECK(energy == Approx(0.3 * sample.element.area * least).margin(1e-6));
        }
    }
}

TEST_CASE("for small strain a membrane follows Hooke's law in plane stress")
{
    std::mt19937 random(6);
    for (double nu : kPoisson) {
        const Sample sample = randomTriangle(random, nu);
        constexpr double a = 1e-4, b = -0.3e-4;
        const double expected = 0.5 * 5.0 / (1.0 - nu * nu) * (a * a + b * b + 2.0 * nu * a * b);
        const double energy = membraneEnergy(sample.element, stretched(sample, random, 1.0 + a, 1.0 + b));
        CHECK(energy == Approx(0.3 * sample.element.area * expected).epsilon(1e-3));
    }
}

TEST_CASE("a membrane that is crushed to a line or a point has finite energy and force, and a point is no minimum")
{
    std::mt19937 random(7);
    for (double nu : kPoisson) {
        const Sample sample = randomTriangle(random, nu);
        double last = 1e300;
        for (double s = 0.0; s <= 1.0; s += 0.01) {
            const double energy = membraneEnergy(sample.element, stretched(sample, random, s, s));
            CHECK(energy <= last + 1e-12);
            last = energy;
        }
        for (const TriangleCorners& x : {stretched(sample, random, 0.0, 0.0), stretched(sample, random, 0.0, 1.0)}) {
            for (const Vec3& force : membraneForces(sample.element, x)) CHECK(isFinite(force));
            const MembraneTangent tangent = membraneTangent(sample.element, x);
            for (const Vec3& each : stiffnessTimes(tangent, randomMotion(random))) CHECK(isFinite(each));
        }
    }
}

TEST_CASE("the principal stretches of a membrane are found in any state")
{
    std::mt19937 random(8);
    const Sample sample = randomTriangle(random, 0.3);
    const auto [high, low] = membraneStretches(sample.element, stretched(sample, random, 0.7, 1.9));
    CHECK(high == Approx(1.9));
    CHECK(low == Approx(0.7));
    CHECK(membraneStretches(sample.element, stretched(sample, random, 0.0, 1.0))[1] < 1e-6);
}

} // namespace membrane_test

#include "filasofia/engine/elastic/element_blocks.h"

#include "filasofia/math/polar.h"
#include "filasofia/math/svd.h"

#include "engine/elastic/element_blocks.h"

namespace element_blocks_test {

using namespace filasofia;
using namespace filasofia::engine;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Deforms the elements in all the ways that occur, one kind after the other.
void deformInManyWays(std::mt19937& random, Elements& all)
{
    for (int e = 0; e < all.count(); ++e) {
        const Mat3 turn = toMat3(randomRotation(random)), any = randomMat3(random, 1.0);
        const Mat3 small = Mat3::identity() + 0.2 * any;
        const Vec3 origin = randomVec3(random, 1.0);
        switch (e % 9) {
        case 0:
            all.deform(e, small, origin);
            break;
        case 1:
            all.deform(e, turn * small, origin);
            break; // also by half a turn: Newton's method does not find this rotation
        case 2:
            all.deform(e, any, origin);
            break;
        case 3:
            all.deform(e, turn * Mat3::diagonal({1.1, 0.9, -0.6}), origin);
            break; // inverted
        case 4:    // flattened: two nodes coincide
            all.deform(e, turn, origin);
            std::copy(all.x[4 * e + 1], all.x[4 * e + 1] + 4, all.x[4 * e + 3]);
            break;
        case 5:
            all.deform(e, 0.0 * any, origin);
            break; // a point
        case 6:
            all.deform(e, 1e6 * any, origin);
            break;
        case 7: // nearly a point: products of floats underflow
            all.deform(e, std::pow(10.0, -8.0 - e / 9 % 13) * toMat3(axisAngle(any.row[0], 0.5)));
            break;
        default:
            all.deform(e, 1e15 * turn);
            break; // products of floats overflow
        }
    }
}

/// Compares an element's results with the double-precision element at the same rotation.
void compareElement(const Elements& all, int e, WorstError& forces, WorstError& products)
{
    const FemElement& element = all.elements[static_cast<std::size_t>(e)];
    const Deformation at{gradient(element, Elements::nodes(all.x, e)), toMat3(normalized(all.rotation(e)))};
    const Lame material = lameAt(lameOf(element), at.f);
    const WarpedTangent tangent = corotationalTangent(material, at, static_cast<double>(kWeights.turning));
    const Corners force = internalForces(element, corotationalStress(material, at));
    const Corners kv = stiffnessTimes(tangent, element, Elements::nodes(all.v, e));
    const Corners kp = stiffnessTimes(tangent, element, Elements::nodes(all.p, e));

    // The lengths of the gradients and of the edges bound every term.
    double steepest = 0.0, edge = 0.0, rate = 0.0, direction = 0.0;
    for (std::size_t k = 1; k < 4; ++k) {
        const auto longest = [&](const NodeArray& array) {
            const Corners nodes = Elements::nodes(array, e);
            return length(nodes[k] - nodes[0]);
        };
        steepest += length(element.gradients[k]);
        edge = std::max(edge, longest(all.x));
        rate = std::max(rate, longest(all.v));
        direction = std::max(direction, longest(all.p));
    }
    const double stiff = element.volume * (2.0 * material.mu + 3.0 * material.lambda) * steepest;
    const double warpedSize = (stiff + element.volume * tangent.turning * steepest) * steepest * kWeights.stiffness;
    for (int i = 0; i < 4; ++i) {
        const auto corner = static_cast<std::size_t>(i);
        const Vec3 expected = -kWeights.force * force[corner] - kWeights.stiffness * kv[corner];
        const Vec3 product = kWeights.stiffness * kp[corner];
        const double size = kWeights.force * stiff * (edge * steepest + 3.0) + warpedSize * rate;
        for (int c = 0; c < 3; ++c) {
            forces.compare(Elements::corner(all.corners, e, i)[c], expected[c], size);
            products.compare(Elements::corner(all.products, e, i)[c], product[c], warpedSize * direction);
        }
        forces.compare(Elements::corner(all.corners, e, i)[3], 0.0, 0.0); // nodes sum up all four floats
        products.compare(Elements::corner(all.products, e, i)[3], 0.0, 0.0);
    }
}

/// Hashes of a run's results: rotations, warped elements, corners, products, quaternions.
std::vector<std::uint64_t> bitsOf(const Elements& all)
{
    return {hashOf(all.rotations.data(), all.rotations.size()),
            std::visit([](const auto& each) { return hashOf(each.data(), each.size()); }, all.tangents),
            hashOf(all.corners), hashOf(all.products), hashOf(all.quaternions)};
}

} // namespace

TEST_CASE("blocks of elements match the double-precision element in every deformation and on every instruction set")
{
    // Lambda is zero in one case, since the sign of det F of a very flat element depends on rounding.
    for (const double poissonRatio : {0.0, 0.45})
        onEveryTarget([&](const std::string&) {
            std::mt19937 random(1);
            Elements all(randomElements(random, 16 * 40 - 5, poissonRatio));
            deformInManyWays(random, all);
            randomMotion(random, all);
            all.run();
            WorstError forces, products, length, optimum;
            for (int e = 0; e < all.count(); ++e) {
                if (e % 9 == 4 && poissonRatio != 0.0) continue;
                compareElement(all, e, forces, products);
                const Mat3 f = gradient(all.elements[static_cast<std::size_t>(e)], Elements::nodes(all.x, e));
                const Quat q = all.rotation(e);
                length.compare(dot(q, q), 1.0, 1.0);
                const Vec3 sigma = svd(f).sigma; // the nearest rotation makes trace(R^T F) their sum
                optimum.compare(contract(toMat3(normalized(q)), f), sigma.x + sigma.y + sigma.z, frobeniusNorm(f));
                const float* copy = all.quaternions.data() + e / kBlock * 64 + linalg::laneOffset(e % kBlock);
                REQUIRE(Quat{copy[3], copy[0], copy[1], copy[2]} == q);
            }
            CHECK(forces.roundings() <= 4);
            CHECK(products.roundings() <= 8);
            CHECK(length.roundings() <= 8);
            CHECK(optimum.roundings() <= 0.1); // the trace loses the square of the angle error
        });
}

TEST_CASE("the blocks on the diagonal of elements are those of their products, with every law and with fibres")
{
    onEveryTarget([](const std::string&) {
        for (const auto& [name, law] : everyLaw()) {
            if (std::holds_alternative<physics::Corotational>(law)) continue;
            INFO(name);
            for (const bool fibres : {false, true}) {
                std::mt19937 random(4);
                Elements all(randomElements(random, 16 * 4 - 3, 0.4), law);
                if (fibres)
                    for (const double dispersion : {0.0, 0.2})
                        all.addFibres({.stiffness = 3.0, .exponent = 1.5, .dispersion = dispersion}, random);
                for (int e = 0; e < all.count(); ++e) {
                    const double size = e % 5 == 0 ? 1.0 : 0.3; // one in five may be inside out
                    all.deform(e, toMat3(randomRotation(random)) * (Mat3::identity() + size * randomMat3(random, 1.0)));
                }
                randomMotion(random, all);
                all.run();
                NodeArray own(all.corners.blocks()), mixed(all.corners.blocks());
                diagonalOfElements(all.tangents, all.fibreTangents, Elements::floats(own), Elements::floats(mixed),
                                   {0, all.blocks});
                WorstError error;
                for (int node = 0; node < 4; ++node)
                    for (int axis = 0; axis < 3; ++axis) {
                        all.p.setZero();
                        for (int e = 0; e < all.count(); ++e) all.p[4 * e + node][axis] = 1.0f;
                        multiplyElements(all.tangents, all.fibreTangents, all.p, Elements::floats(all.products),
                                         {0, all.blocks});
                        for (int e = 0; e < all.count(); ++e) {
                            const float *a = Elements::corner(own, e, node), *b = Elements::corner(mixed, e, node);
                            const Mat3 block{{{a[0], b[2], b[1]}, {b[2], a[1], b[0]}, {b[1], b[0], a[2]}}};
                            const Vec3 column = vectorOf(Elements::corner(all.products, e, node));
                            for (int k = 0; k < 3; ++k)
                                error.compare(static_cast<float>(block[k][axis]), column[k], frobeniusNorm(block));
                            CHECK(a[3] == 0.0f);
                            CHECK(b[3] == 0.0f);
                        }
                    }
                CHECK(error.roundings() <= 60);
            }
        }
    });
}

TEST_CASE("lanes behind the last element contribute nothing")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(2);
        Elements all(randomElements(random, 20, 0.4));
        deformInManyWays(random, all);
        randomMotion(random, all);
        all.run();
        for (int lane = 0; lane < 32; ++lane)
            for (int i = 0; i < 4; ++i)
                for (const NodeArray* array : {&all.corners, &all.products}) {
                    const bool zero = vectorOf(Elements::corner(*array, lane, i)) == Vec3{};
                    if (lane >= 20) CHECK(zero);
                    if (lane == 0) CHECK(!zero);
                }
    });
}

TEST_CASE("a run over a range of blocks changes these blocks only")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(3);
        Elements all(randomElements(random, 16 * 5, 0.4));
        deformInManyWays(random, all);
        randomMotion(random, all);
        Elements some = all;
        all.run();
        updateElements(some.law, some.elementBlocks, {some.x, some.v, kWeights}, {1, 4}, some.output());
        multiplyElements(some.tangents, {}, some.p, Elements::floats(some.products), {2, 3});
        for (int lane = 0; lane < 16 * 5; ++lane) {
            const bool updated = lane / 16 >= 1 && lane / 16 < 4, multiplied = lane / 16 == 2;
            const auto say = [&](const NodeArray& a) { return vectorOf(Elements::corner(a, lane, 1)); };
            CHECK(say(some.corners) == (updated ? say(all.corners) : Vec3{}));
            CHECK(say(some.products) == (multiplied ? say(all.products) : Vec3{}));
            CHECK(some.rotation(lane) == (updated ? all.rotation(lane) : Quat{}));
        }
    });
}

TEST_CASE("the nearest rotation is found from the identity, however far away, and from the last step's rotation")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(4);
        Elements all(randomElements(random, 16 * 40, 0.3));
        std::vector<Mat3> shapes;
        for (int e = 0; e < all.count(); ++e)
            shapes.push_back(e % 2 ? toMat3(randomRotation(random)) * (Mat3::identity() + 0.3 * randomMat3(random, 1.0))
                                   : randomMat3(random, 1.0));
        for (const double moved : {0.0, 2e-3, 2e-2, 0.2}) {
            WorstError worst;
            for (int e = 0; e < all.count(); ++e)
                all.deform(e, shapes[static_cast<std::size_t>(e)] + moved * randomMat3(random, 1.0));
            all.run();
            for (int e = 0; e < all.count(); ++e) {
                const Mat3 f = gradient(all.elements[static_cast<std::size_t>(e)], Elements::nodes(all.x, e));
                const Quat exact = polarRotation(f, {}), found = normalized(all.rotation(e));
                // A change of F changes R by at most that change over the sum of the two smaller singular values.
                const Vec3 sigma = svd(f).sigma;
                const double sensitivity = frobeniusNorm(f) / (sigma.y + sigma.z);
                worst.compare(length(rotationVector(conjugate(exact) * found)), 0.0, sensitivity);
            }
            CHECK(worst.roundings() <= 10);
        }
    });
}

TEST_CASE("a rotation that Newton's method does not find keeps the sign of its quaternion")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(5);
        Elements all(randomElements(random, 16 * 4, 0.3));
        std::vector<Quat> before;
        for (int e = 0; e < all.count(); ++e) {
            all.deform(e, toMat3(axisAngle(randomVec3(random, 1.0), 2.8)));
            before.push_back(e % 2 ? Quat{-1, 0, 0, 0} : Quat{1, 0, 0, 0});
            all.rotations[static_cast<std::size_t>(e / kBlock)].w[e % kBlock] = e % 2 ? -1.0f : 1.0f;
        }
        all.run();
        for (int e = 0; e < all.count(); ++e) CHECK(dot(all.rotation(e), before[static_cast<std::size_t>(e)]) > 0.1);
    });
}

TEST_CASE("instruction sets with fused multiply-add give the same bits, even if one element of a block has jumped")
{
    linalg::checkSameBitsWhereFused([] {
        std::mt19937 random(6);
        Elements all(randomElements(random, 16 * 20, 0.4));
        for (int e = 0; e < all.count(); ++e) {
            // The other elements of its block stop after one step or after many.
            const bool jumps = e / kBlock < 16 && e % kBlock == e / kBlock;
            const Mat3 f = toMat3(axisAngle(randomVec3(random, 1.0), jumps ? 3.0 : 1.5 * (e % 7) / 7.0));
            // At the identity Newton's method needs a positive trace, which the element that jumped lacks.
            REQUIRE((trace(f) < 0.0) == jumps);
            all.deform(e, f * (Mat3::identity() + 0.1 * (e % 3) * randomMat3(random, 1.0)), randomVec3(random, 1.0));
        }
        randomMotion(random, all);
        all.run();
        std::vector<std::uint64_t> bits = bitsOf(all);
        deformInManyWays(random, all); // starting from these rotations
        all.run();
        for (const std::uint64_t each : bitsOf(all)) bits.push_back(each);
        return bits;
    });
}

TEST_CASE("a position that is not finite affects only its own element, whose rotation stays")
{
    onEveryTarget([](const std::string&) {
        for (const double bad : {std::numeric_limits<double>::quiet_NaN(), kInfinity, -kInfinity, 3e38}) {
            std::mt19937 random(7);
            Elements all(randomElements(random, 16 * 3, 0.4));
            deformInManyWays(random, all);
            randomMotion(random, all);
            Elements spoiled = all;
            const int lane = 21;
            spoiled.x[4 * lane + 2][1] = static_cast<float>(bad);
            all.run();
            spoiled.run();
            if (!std::isfinite(bad)) CHECK(spoiled.rotation(lane) == Quat{});
            CHECK(isFinite(spoiled.rotation(lane)));
            for (int e = 0; e < all.count(); ++e) {
                bool same = spoiled.rotation(e) == all.rotation(e);
                for (int i = 0; i < 4; ++i)
                    for (const auto& array : {&Elements::corners, &Elements::products})
                        same = same && std::memcmp(Elements::corner(spoiled.*array, e, i),
                                                   Elements::corner(all.*array, e, i), 16) == 0;
                CHECK(same == (e != lane));
            }
            if (std::isfinite(bad)) continue;
            spoiled.x = all.x; // after the position is restored, the rotation is too
            spoiled.run();
            CHECK(spoiled.rotation(lane) == all.rotation(lane));
        }
    });
}

TEST_CASE("forces are minus the gradient of the energy, also in inverted elements")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(8);
        Elements all(randomElements(random, 16 * 4, 0.4));
        for (int e = 0; e < all.count(); ++e) {
            const double last = e % 2 ? -0.5 : 0.5; // away from det F = 0, where the energy is discontinuous
            all.deform(e, toMat3(randomRotation(random)) * Mat3::diagonal({1.3, 0.8, last}) *
                              toMat3(randomRotation(random)));
        }
        all.run();
        for (int e = 0; e < all.count(); ++e) {
            const FemElement& element = all.elements[static_cast<std::size_t>(e)];
            const auto energy = [&](const Corners& x) { return energyOf(all.law, element, x); };
            const double h = 1e-5; // error h^2 plus double rounding over h, far below float rounding
            double error = 0.0, size = 0.0;
            for (int k = 0; k < 12; ++k) {
                Corners more = Elements::nodes(all.x, e), less = more;
                more[static_cast<std::size_t>(k / 3)][k % 3] += h;
                less[static_cast<std::size_t>(k / 3)][k % 3] -= h;
                const double expected = static_cast<double>(kWeights.force) * (energy(less) - energy(more)) / (2.0 * h);
                error = std::max(error, std::abs(Elements::corner(all.corners, e, k / 3)[k % 3] - expected));
                size = std::max(size, std::abs(expected));
            }
            CHECK(error <= 1e-5 * size);
        }
    });
}

TEST_CASE("the product of elements equals their assembled warped stiffness, symmetric and positive semi-definite")
{
    onEveryTarget([](const std::string&) {
        std::mt19937 random(9);
        Elements all(randomElements(random, 16 * 10, 0.4));
        for (int e = 0; e < all.count(); ++e) all.deform(e, randomMat3(random, 1.0));
        randomMotion(random, all);
        all.run();
        const NodeArray p = all.p, q = all.v, kp = all.products;
        multiplyElements(all.tangents, {}, q, Elements::floats(all.products), {0, all.blocks});
        WorstError blocks, symmetry;
        for (int e = 0; e < all.count(); ++e) {
            const FemElement& element = all.elements[static_cast<std::size_t>(e)];
            const Deformation at{gradient(element, Elements::nodes(all.x, e)), toMat3(normalized(all.rotation(e)))};
            const WarpedTangent tangent =
                corotationalTangent(lameOf(element), at, static_cast<double>(kWeights.turning));
            const Corners& g = element.gradients;
            double pkq = 0.0, qkp = 0.0, pkp = 0.0, energy = 0.0, largest = 0.0;
            for (int i = 0; i < 4; ++i) {
                Vec3 product;
                double size = 0.0;
                for (int j = 0; j < 4; ++j) {
                    const Mat3 block =
                        kWeights.stiffness * element.volume *
                        stiffnessBlock(tangent, g[static_cast<std::size_t>(i)], g[static_cast<std::size_t>(j)]);
                    product += block * vectorOf(p[4 * e + j]);
                    size += frobeniusNorm(block) * length(vectorOf(p[4 * e + j]));
                }
                const Vec3 found = vectorOf(Elements::corner(kp, e, i));
                for (int c = 0; c < 3; ++c) blocks.compare(found[c], product[c], size);
                pkq += dot(vectorOf(p[4 * e + i]), vectorOf(Elements::corner(all.products, e, i)));
                qkp += dot(vectorOf(q[4 * e + i]), found);
                pkp += dot(vectorOf(p[4 * e + i]), found);
                energy += dot(vectorOf(p[4 * e + i]), product);
                largest += size * (length(vectorOf(q[4 * e + i])) + length(vectorOf(p[4 * e + i])));
            }
            symmetry.compare(pkq, qkp, largest);
            symmetry.compare(pkp, std::max(energy, 0.0), largest);
        }
        CHECK(blocks.roundings() <= 10);
        CHECK(symmetry.roundings() <= 10);
    });
}

} // namespace element_blocks_test

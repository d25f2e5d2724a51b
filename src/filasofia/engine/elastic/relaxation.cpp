#include "filasofia/engine/elastic/relaxation.h"

#include <cmath>

namespace filasofia::engine {
namespace {

constexpr std::size_t kEntries[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};

Mat3 symmetric(const float (&entries)[kSymmetric][kElementsPerBlock], std::size_t lane)
{
    Mat3 out;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) out[i][j] = static_cast<double>(entries[kEntries[i][j]][lane]);
    return out;
}

void store(const Mat3& m, std::size_t lane, float (&entries)[kSymmetric][kElementsPerBlock])
{
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j)
            entries[kEntries[i][j]][lane] = static_cast<float>(0.5 * (m[i][j] + m[j][i]));
}

} // namespace

PronyFactors pronyFactors(std::span<const physics::PronyTerm> terms, double dt)
{
    PronyFactors out;
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const double ratio = dt / terms[i].time;
        out.decay[i] = std::exp(-ratio);
        out.gain[i] = ratio > 0.0 ? -terms[i].share * std::expm1(-ratio) / ratio : terms[i].share;
    }
    return out;
}

RelaxationStep relaxationStep(std::span<const physics::PronyTerm> terms, double past, double dt)
{
    RelaxationStep step{terms.size(), pronyFactors(terms, past), pronyFactors(terms, dt), 1.0, 1.0};
    for (std::size_t i = 0; i < terms.size(); ++i) {
        step.present -= terms[i].share;
        step.tangent += step.ahead.gain[i] - terms[i].share;
    }
    return step;
}

double relaxationTangent(std::span<const physics::PronyTerm> terms, double dt)
{
    return relaxationStep(terms, 0.0, dt).tangent;
}

Mat3 updateRelaxation(const RelaxationStep& step, const Mat3& stress, std::size_t lane, ElementRelaxation& state)
{
    const Mat3 change = stress - symmetric(state.stress, lane);
    Mat3 total = step.present * stress;
    for (std::size_t i = 0; i < step.terms; ++i) {
        const Mat3 term = step.past.decay[i] * symmetric(state.terms[i], lane) + step.past.gain[i] * change;
        store(term, lane, state.terms[i]);
        total += step.ahead.decay[i] * term;
    }
    store(stress, lane, state.stress);
    return total;
}

Mat3 relaxedStress(const RelaxationStep& step, const Mat3& stress, std::size_t lane, const ElementRelaxation& state)
{
    const Mat3 change = stress - symmetric(state.stress, lane);
    Mat3 total = step.present * stress;
    for (std::size_t i = 0; i < step.terms; ++i)
        total += step.ahead.decay[i] * symmetric(state.terms[i], lane) + step.ahead.gain[i] * change;
    return total;
}

void copyRelaxation(std::size_t from, std::size_t to, std::span<ElementRelaxation> all)
{
    const ElementRelaxation& source = all[from / kElementsPerBlock];
    ElementRelaxation& target = all[to / kElementsPerBlock];
    const std::size_t a = from % kElementsPerBlock, b = to % kElementsPerBlock;
    for (std::size_t k = 0; k < kSymmetric; ++k) {
        target.stress[k][b] = source.stress[k][a];
        for (std::size_t i = 0; i < kMostPronyTerms; ++i) target.terms[i][k][b] = source.terms[i][k][a];
    }
}

} // namespace filasofia::engine

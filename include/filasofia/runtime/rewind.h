#pragma once

#include "filasofia/core/fields.h"

#include <cstddef>
#include <memory>
#include <optional>

namespace filasofia::runtime {

class Simulation;

/// How much of a run a Rewind keeps.
struct RewindDef {
    double rate = 25.0; ///< [1/s], in [1, 1000], states kept per second of simulated time
    /// [bytes], in [1e4, 1e11], of the states together. If they grow beyond it, every second one is dropped, and the
    /// rate is halved from then on.
    double memory = 256e6;
};
constexpr auto fields(const RewindDef*)
{
    using T = RewindDef;
    return describe("RewindDef", field("rate", &T::rate, "1/s", closed(1, 1000), "states kept per second"),
                    field("memory", &T::memory, "bytes", closed(1e4, 1e11), "of the states together"));
}

/// Keeps the states of a run as they are drawn, and draws them again, at once and in any order: nothing is computed a
/// second time. Between two states bodies are drawn on the straight way from the one to the other.
///
/// It keeps where bodies are and how they are cut. Paint, blood, burns and smoke stay as they are now, and so does a
/// body that was added later. States are kept when a picture is drawn, so a run without pictures has none.
class Rewind {
public:
    /// Construct it before a run, and destroy it before the simulation. Throws an Error if the Def is wrong, during a
    /// run, and if the simulation has one already.
    explicit Rewind(Simulation& simulation, const RewindDef& def = {});
    ~Rewind();
    Rewind(const Rewind&) = delete;
    Rewind& operator=(const Rewind&) = delete;

    // The thread that draws (the main thread, as in callbacks of Guis), or any thread between two runs.

    [[nodiscard]] double begin() const;       ///< [s], simulated time of the first state; 0 if there is none
    [[nodiscard]] double end() const;         ///< [s], simulated time of the last state
    [[nodiscard]] std::size_t states() const; ///< [-], how many it keeps
    [[nodiscard]] std::size_t bytes() const;  ///< what they take
    /// From the next picture on, the state of this time [s] is drawn, or the nearest one that is kept.
    void show(double time);
    void showNewest();                                 ///< from the next picture on, the newest state is drawn again
    [[nodiscard]] std::optional<double> shown() const; ///< [s], the time given to show(), if it is in force

private:
    struct Impl;
    std::shared_ptr<Impl> impl_;
};

} // namespace filasofia::runtime

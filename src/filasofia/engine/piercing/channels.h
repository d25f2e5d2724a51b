#pragma once

#include "filasofia/engine/contact/coupling.h"

/// Needles in tissue (Duriez, Guebert, Marchal, Cotin and Grisoni 2009: constraints between a needle and points of the
/// tissue, without remeshing). A channel is the path that a tip has cut: points fixed in the tissue. In a step each is
/// a spring between the tissue and the place of the needle, or of the thread behind it, that is nearest. Across the
/// line the spring is linear, along it the force is bounded by friction, so the line slides. The tip is pushed back by
/// at most the force that cuts.
namespace filasofia::engine {

/// Parts the lines of channels that are not tied to each other any more.
void partLines(Scene& scene);

/// Removes contacts between tissue and the lines that run through it, where they do, among the contacts from number
/// `begin` on. At a channel's mouths contacts become springs as stiff as the channel, unless they are springs already.
/// dt [s]: nothing becomes a spring if it is zero.
void leaveToChannels(double dt, const Scene& scene, Coupling& coupling, std::size_t begin = 0);

/// Makes a spring of a contact between a tip that is driven and pinned tissue, at which it pushes: neither can move, so
/// no force follows from their motion. It takes up a radius at the force that pierces; several at one tip share that
/// force, and take up less.
void yieldToTips(double dt, const Scene& scene, Coupling& coupling);

/// Adds the constraints of all channels after the welds.
void addChannels(const StepContext& context, const Scene& scene, Coupling& coupling);

/// After the solve: what slid, how far the tips have cut, and the channels' forces. A channel that nothing runs through
/// any more is removed.
void keepChannels(double dt, const Coupling& coupling, Scene& scene);

/// Begins a channel where a needle's tip pushed harder in this step than the tissue's surface bears.
void puncture(double dt, const Coupling& coupling, Scene& scene);

/// Removes the channels in a body.
void removeChannelsOf(BodyId id, Scene& scene);

} // namespace filasofia::engine

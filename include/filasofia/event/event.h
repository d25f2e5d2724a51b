#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace filasofia::event {

/// The type that an observer attaches to. Custom1 to Custom4 are the user's: any class derived from Event, any payload.
enum class EventType : std::uint8_t {
    PhysicsUpdate,
    VisualUpdate,
    MouseButton,
    MouseMove,
    MouseWheel,
    Key,
    TextInput,
    Window,
    Contact,
    Cut,
    Tear,
    Intersection,
    Bleeding,
    Burn,
    Energy,
    Duct,
    Clip,
    Break,
    Distension,
    FileFailed,
    Device,
    Controller,
    Custom1,
    Custom2,
    Custom3,
    Custom4,
};
inline constexpr std::size_t kEventTypes = 26;

/// The enumerator's name, such as "PhysicsUpdate".
std::string_view name(EventType type);

/// Queued events with equal keys become one event: the newest. `value` distinguishes events that must not merge (such
/// as the pair of bodies of a contact).
struct MergeKey {
    EventType type = EventType::Custom1;
    std::uint64_t value = 0;

    friend constexpr auto operator<=>(const MergeKey&, const MergeKey&) = default;
};

/// Something that happened. Derive from it, add plain data and a `static constexpr EventType kType`, and post it; a
/// custom event may instead get its type at construction.
class Event {
public:
    virtual ~Event();

    /// If empty, the event is delivered, whatever is posted after it. Otherwise it replaces a queued event with the
    /// same key. Called once, by the posting thread.
    [[nodiscard]] virtual std::optional<MergeKey> mergeKey() const;

    /// Takes over what must not get lost of an older event with the same key, which is never delivered (a mouse move
    /// adds up the displacements). Called at most once per older event, by a posting thread or by the delivering one;
    /// it must not call a dispatcher.
    virtual void absorb(const Event& older) noexcept;

    EventType type;
    double time = 0.0;      ///< [s], >= 0, simulated time
    std::uint64_t step = 0; ///< [-], steps completed when it happened

protected:
    explicit Event(EventType itsType) : type(itsType) {}
    Event(const Event&) = default; // protected, because copying the base class alone would cut off the payload
    Event& operator=(const Event&) = default;
};

/// Takes events from their sources; the simulation's sink stamps time and step and posts them.
using EventSink = std::function<void(std::unique_ptr<Event>)>;

/// A physics step is done. Merges: an observer that is slower than physics sees only the newest step.
class PhysicsUpdateEvent final : public Event {
public:
    static constexpr EventType kType = EventType::PhysicsUpdate;
    PhysicsUpdateEvent() : Event(kType) {}
    [[nodiscard]] std::optional<MergeKey> mergeKey() const override { return MergeKey{type}; }
};

/// A picture was drawn. Merges like PhysicsUpdateEvent.
class VisualUpdateEvent final : public Event {
public:
    static constexpr EventType kType = EventType::VisualUpdate;
    VisualUpdateEvent() : Event(kType) {}
    [[nodiscard]] std::optional<MergeKey> mergeKey() const override { return MergeKey{type}; }
};

} // namespace filasofia::event

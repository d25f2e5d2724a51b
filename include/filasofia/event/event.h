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

/// What an observer attaches to. Custom1 to Custom4 are the user's: any class derived from Event, any payload.
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
    Trouble,
    Custom1,
    Custom2,
    Custom3,
    Custom4,
};
inline constexpr std::size_t kEventTypes = 16;

/// "PhysicsUpdate", as the enumerator is spelled.
std::string_view name(EventType type);

/// Waiting events of one key are one event: the newest. `value` tells apart what must not merge (a pair of bodies).
struct MergeKey {
    EventType type = EventType::Custom1;
    std::uint64_t value = 0;

    friend constexpr auto operator<=>(const MergeKey&, const MergeKey&) = default;
};

/// Something that happened. Derive, add plain data and a `static constexpr EventType kType`, and post it; a custom
/// event's type may as well be given when it is made.
class Event {
public:
    virtual ~Event();

    /// Empty: the event is delivered, whatever comes after it. Else a waiting event of the same key gives way to this
    /// one. Called by the poster, once.
    [[nodiscard]] virtual std::optional<MergeKey> mergeKey() const;

    /// Keeps what must not get lost of an older event of the same key that is never delivered (a mouse sums up its
    /// ways). Called at most once per older event, by a poster or by the deliverer; it calls no dispatcher.
    virtual void absorb(const Event& older) noexcept;

    EventType type;
    double time = 0.0;      ///< [s], >= 0, of the simulation
    std::uint64_t step = 0; ///< [-], of the simulation: steps done when it happened

protected:
    explicit Event(EventType itsType) : type(itsType) {}
    Event(const Event&) = default; // protected: a copy of the base alone would cut off the payload
    Event& operator=(const Event&) = default;
};

/// Takes events from whoever makes them; the simulation's sink stamps time and step and posts them.
using EventSink = std::function<void(std::unique_ptr<Event>)>;

/// A physics step is done. Merges: an observer that is slower than physics sees the newest step only.
class PhysicsUpdateEvent final : public Event {
public:
    static constexpr EventType kType = EventType::PhysicsUpdate;
    PhysicsUpdateEvent() : Event(kType) {}
    [[nodiscard]] std::optional<MergeKey> mergeKey() const override { return MergeKey{type}; }
};

/// A picture is drawn. Merges like PhysicsUpdateEvent.
class VisualUpdateEvent final : public Event {
public:
    static constexpr EventType kType = EventType::VisualUpdate;
    VisualUpdateEvent() : Event(kType) {}
    [[nodiscard]] std::optional<MergeKey> mergeKey() const override { return MergeKey{type}; }
};

/// Something beside the simulation gave up, and the simulation goes on without it: a record whose disk is full. The log
/// has the same line.
class TroubleEvent final : public Event {
public:
    static constexpr EventType kType = EventType::Trouble;
    TroubleEvent() : Event(kType) {}

    std::string what = {};
};

} // namespace filasofia::event

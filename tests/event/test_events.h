#pragma once

#include "filasofia/core/log.h"
#include "filasofia/event/event_dispatcher.h"

#include <atomic>
#include <mutex>

/// Events that only the tests know, as a user would write them.
namespace filasofia::event {

/// Never merges; `number` identifies it.
class NumberEvent final : public Event {
public:
    static constexpr EventType kType = EventType::Custom1;
    explicit NumberEvent(int itsNumber, EventType itsType = kType) : Event(itsType), number(itsNumber) {}
    int number = 0;
};

/// A contact that continues: merges with those of the same pair.
class TouchEvent final : public Event {
public:
    static constexpr EventType kType = EventType::Contact;
    TouchEvent(std::uint64_t itsPair, int itsNumber) : Event(kType), pair(itsPair), number(itsNumber) {}
    [[nodiscard]] std::optional<MergeKey> mergeKey() const override { return MergeKey{type, pair}; }
    void absorb(const Event& older) noexcept override { absorbed += static_cast<const TouchEvent&>(older).absorbed; }

    std::uint64_t pair = 0;
    int number = 0;
    int absorbed = 1; // the number of events that this one stands for
};

/// Counts how many objects of its class exist.
class CountedEvent final : public Event {
public:
    explicit CountedEvent(std::atomic<int>& count, bool merges = false)
        : Event(EventType::Custom2), alive(count), mergeable(merges)
    {
        ++alive;
    }
    ~CountedEvent() override { --alive; }
    [[nodiscard]] std::optional<MergeKey> mergeKey() const override
    {
        if (mergeable) return MergeKey{type};
        return std::nullopt;
    }
    std::atomic<int>& alive;
    bool mergeable;
};

/// Collects the log's lines while it exists.
class LogLines {
public:
    LogLines()
    {
        setLogSink([this](LogLevel, std::string_view line) {
            const std::lock_guard lock(mutex_);
            lines_.emplace_back(line);
        });
    }
    ~LogLines() { setLogSink(nullptr); }
    std::vector<std::string> lines()
    {
        const std::lock_guard lock(mutex_);
        return lines_;
    }

private:
    std::mutex mutex_;
    std::vector<std::string> lines_;
};

} // namespace filasofia::event

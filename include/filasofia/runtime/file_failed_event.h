#pragma once

#include "filasofia/event/event.h"

#include <string>

namespace filasofia::runtime {

/// A file that a run or a MetricTracker writes as it goes took no more data: the disk is full. The run goes on without
/// it, and what was written stays. Posted once per file.
class FileFailedEvent final : public event::Event {
public:
    static constexpr event::EventType kType = event::EventType::FileFailed;
    FileFailedEvent() : Event(kType) {}

    std::string problem = {}; ///< with the file's name
};

} // namespace filasofia::runtime

#include "filasofia/event/observer_list.h"

#include "filasofia/core/assert.h"
#include "filasofia/core/guarded_call.h"
#include "filasofia/core/log.h"
#include "filasofia/event/wait_cycle.h"

#include <algorithm>

namespace filasofia::event {

ObserverId ObserverList::attach(EventType type, EventDispatcher::Callback callback)
{
    const auto index = static_cast<std::size_t>(type);
    FILASOFIA_ASSERT(index < kEventTypes && callback);
    const auto observer = std::make_shared<Observer>();
    observer->callback = std::move(callback);
    const std::lock_guard lock(mutex_);
    observer->id = ++lastId_;
    auto longer = lists_[index] ? std::make_shared<Observers>(*lists_[index]) : std::make_shared<Observers>();
    longer->push_back(observer);
    lists_[index] = std::move(longer);
    return {observer->id};
}

std::shared_ptr<ObserverList::Observer> ObserverList::remove(std::uint64_t id)
{
    for (auto& list : lists_) {
        if (!list) continue;
        const auto found = std::find_if(list->begin(), list->end(), [&](const auto& each) { return each->id == id; });
        if (found == list->end()) continue;
        std::shared_ptr<Observer> observer = *found;
        auto shorter = std::make_shared<Observers>(*list);
        std::erase(*shorter, observer);
        list = std::move(shorter);
        observer->detached = true;
        return observer;
    }
    return nullptr;
}

bool ObserverList::detach(ObserverId id)
{
    EventDispatcher::Callback last; // freed after the lock, because destructors of what it owns may call the dispatcher
    std::unique_lock lock(mutex_);
    const std::shared_ptr<Observer> observer = remove(id.value);
    if (running_ != id.value || !id) {
        if (observer) last.swap(observer->callback);
        return true;
    }
    if (runner_ == std::this_thread::get_id()) return false;
    if (!wait_cycle::enter(runner_)) return false;
    waiters_.push_back(std::this_thread::get_id());
    ended_.wait(lock, [&] { return running_ != id.value; }); // it is off the list, so it cannot begin again
    return true;
}

void ObserverList::deliver(const Event& event)
{
    std::shared_ptr<const Observers> list;
    {
        const std::lock_guard lock(mutex_);
        list = lists_[static_cast<std::size_t>(event.type)];
    }
    if (!list) return;
    for (const std::shared_ptr<Observer>& observer : *list) call(*observer, event);
}

void ObserverList::call(Observer& observer, const Event& event)
{
    if (!begin(observer)) return;
    const std::optional<std::string> problem = guardedCall([&] { observer.callback(event); });
    end(observer, problem.has_value());
    if (problem)
        logError("event dispatcher: an observer of ", name(event.type), " events threw at step ", event.step,
                 " and was detached: ", *problem);
}

bool ObserverList::begin(const Observer& observer)
{
    const std::lock_guard lock(mutex_);
    if (observer.detached) return false;
    running_ = observer.id;
    runner_ = std::this_thread::get_id();
    return true;
}

void ObserverList::end(Observer& observer, bool failed)
{
    std::unique_lock lock(mutex_);
    if (failed) remove(observer.id);
    if (observer.detached) {
        // What the callback owns is freed before detach() returns, and without the lock.
        EventDispatcher::Callback last;
        last.swap(observer.callback);
        lock.unlock();
        last = nullptr;
        lock.lock();
    }
    running_ = 0;
    runner_ = {};
    for (const std::thread::id waiter : waiters_) wait_cycle::leave(waiter);
    waiters_.clear();
    // Notify with the lock held: once it is released, a detach() that returns may be followed by the destruction of
    // this object.
    ended_.notify_all();
}

} // namespace filasofia::event

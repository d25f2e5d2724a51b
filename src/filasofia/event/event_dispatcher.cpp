#include "filasofia/event/event_dispatcher.h"

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/core/validate.h"
#include "filasofia/event/event_queue.h"
#include "filasofia/event/observer_list.h"

#include <system_error>

namespace filasofia::event {

struct EventDispatcher::Impl {
    enum class Quit { No, WhenDelivered, AtOnce };

    explicit Impl(const EventDispatcherDef& asked)
        : def(asked), queue(static_cast<std::size_t>(def.capacity), static_cast<std::size_t>(def.mergePlaces))
    {
    }

    void claimDelivery();
    void releaseDelivery();
    [[nodiscard]] bool insideCallback() const { return deliverer.load() == std::this_thread::get_id(); }
    void wakeThread();
    void threadLoop();
    std::size_t deliverBatch();
    std::optional<std::size_t> deliverRounds();
    [[noreturn]] void failRounds() const;
    void endThread(Quit how);

    const EventDispatcherDef def;
    EventQueue queue;
    ObserverList observers;

    std::atomic<bool> delivering = false;   // whether a thread has the right to deliver
    std::atomic<std::thread::id> deliverer; // the thread that delivers now
    bool answered = false;                  // a callback has posted; only the delivering thread uses it
    std::vector<QueuedEvent> batch;         // only the delivering thread uses it

    std::mutex lifecycle; // guards the thread: start(), stop()
    std::thread thread;
    bool finished = true;                 // the thread's last rounds were enough; read after join
    std::atomic<Quit> quit = Quit::No;    // what the thread is asked to do
    std::atomic<std::uint32_t> wakes = 0; // changes with every post; 32 bits because a futex waits on 32

    std::atomic<std::uint64_t> refused = 0;
    std::atomic<std::uint64_t> delivered = 0;
    std::atomic<std::uint64_t> skipped = 0;
};

void EventDispatcher::Impl::claimDelivery()
{
    if (insideCallback())
        fail("event dispatcher: deliverAll() and start() must not be called from a callback; post the events instead");
    if (delivering.exchange(true)) fail("event dispatcher: another thread is already delivering events");
}

void EventDispatcher::Impl::releaseDelivery()
{
    deliverer.store({});
    delivering.store(false);
}

// An observer gets an event at once or, if the thread is busy, with its next batch. Neither line waits.
void EventDispatcher::Impl::wakeThread()
{
    wakes.fetch_add(1, std::memory_order_release);
    wakes.notify_one();
}

std::size_t EventDispatcher::Impl::deliverBatch()
{
    queue.collect(batch);
    std::size_t count = 0;
    for (QueuedEvent& item : batch) {
        if (quit.load(std::memory_order_relaxed) == Quit::AtOnce) break;
        observers.deliver(*item.event);
        item.event.reset();
        delivered.fetch_add(1, std::memory_order_relaxed);
        ++count;
    }
    batch.clear();
    return count;
}

// Only what callbacks post asks for another round, so a thread that posts without end does not keep this loop running.
std::optional<std::size_t> EventDispatcher::Impl::deliverRounds()
{
    std::size_t count = 0;
    for (int round = 0; round < def.maximumRounds; ++round) {
        answered = false;
        count += deliverBatch();
        if (!answered) return count;
    }
    return std::nullopt;
}

void EventDispatcher::Impl::failRounds() const
{
    fail("event dispatcher: observers still answer events with events after ", def.maximumRounds,
         " rounds (maximumRounds)");
}

void EventDispatcher::Impl::threadLoop()
{
    deliverer.store(std::this_thread::get_id());
    for (;;) {
        const std::uint32_t seen =
            wakes.load(std::memory_order_acquire); // read before looking, so that a later post is not missed
        const Quit asked = quit.load(std::memory_order_acquire);
        if (asked == Quit::WhenDelivered) finished = deliverRounds().has_value();
        if (asked != Quit::No) return;
        if (deliverBatch() == 0) wakes.wait(seen, std::memory_order_acquire);
    }
}

void EventDispatcher::Impl::endThread(Quit how)
{
    if (!thread.joinable()) return;
    finished = true;
    quit.store(how, std::memory_order_release);
    wakeThread();
    thread.join();
    quit.store(Quit::No);
    releaseDelivery();
}

EventDispatcher::EventDispatcher(const EventDispatcherDef& def)
{
    validate(def, "event dispatcher");
    impl_ = std::make_unique<Impl>(def);
}

EventDispatcher::~EventDispatcher()
{
    FILASOFIA_ASSERT(!impl_->insideCallback());
    const std::lock_guard lock(impl_->lifecycle);
    impl_->endThread(Impl::Quit::AtOnce);
}

ObserverId EventDispatcher::attach(EventType type, Callback callback)
{
    return impl_->observers.attach(type, std::move(callback));
}

bool EventDispatcher::detach(ObserverId id) { return impl_->observers.detach(id); }

void EventDispatcher::post(std::unique_ptr<Event> event)
{
    if (!event) fail("event dispatcher: post() needs an event, got null");
    const EventType type = event->type;
    if (!tryPost(std::move(event)))
        fail("event dispatcher: the queue is full: ", impl_->def.capacity, " events are waiting (capacity); the ",
             name(type), " event was refused");
}

bool EventDispatcher::tryPost(std::unique_ptr<Event>&& event)
{
    FILASOFIA_ASSERT(event && static_cast<std::size_t>(event->type) < kEventTypes);
    if (!impl_->queue.tryPush(event)) {
        impl_->refused.fetch_add(1, std::memory_order_relaxed);
        return false;
    }
    if (impl_->insideCallback()) impl_->answered = true;
    impl_->wakeThread();
    return true;
}

std::size_t EventDispatcher::deliverAll()
{
    impl_->claimDelivery();
    impl_->deliverer.store(std::this_thread::get_id());
    struct Release {
        Impl& impl;
        ~Release() { impl.releaseDelivery(); }
    } const release{*impl_};
    const std::optional<std::size_t> count = impl_->deliverRounds();
    if (!count) impl_->failRounds();
    return *count;
}

void EventDispatcher::start()
{
    impl_->claimDelivery();
    const std::lock_guard lock(impl_->lifecycle);
    try {
        impl_->thread = std::thread([impl = impl_.get()] { impl->threadLoop(); });
    } catch (const std::system_error& error) {
        impl_->releaseDelivery();
        fail("event dispatcher: cannot start its thread: ", error.what());
    }
}

void EventDispatcher::stop()
{
    if (impl_->insideCallback())
        fail("event dispatcher: stop() must not be called from a callback, whose own thread it would end");
    const std::lock_guard lock(impl_->lifecycle);
    impl_->endThread(Impl::Quit::WhenDelivered);
    if (!std::exchange(impl_->finished, true)) impl_->failRounds();
}

std::uint64_t EventDispatcher::merged() const { return impl_->queue.merged(); }
std::uint64_t EventDispatcher::refused() const { return impl_->refused.load(); }
std::uint64_t EventDispatcher::delivered() const { return impl_->delivered.load(); }
std::uint64_t EventDispatcher::skipped() const { return impl_->skipped.load(); }

void EventDispatcher::skip(const Event& event, bool warn)
{
    impl_->skipped.fetch_add(1, std::memory_order_relaxed);
    if (warn)
        logWarning("event dispatcher: an observer of ", name(event.type),
                   " events skips events of this type that are of another class, ", "first at step ", event.step);
}

} // namespace filasofia::event

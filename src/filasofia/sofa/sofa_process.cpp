#include "filasofia/sofa/sofa_process.h"

#include "filasofia/core/log.h"

#include <sofa/helper/logging/Message.h>
#include <sofa/helper/logging/MessageDispatcher.h>
#include <sofa/helper/logging/MessageHandler.h>
#include <sofa/simulation/graph/init.h>

#include <cstdlib>

namespace filasofia::sofaengine {
namespace {

using ::sofa::helper::logging::Message;

std::vector<std::string>* collected = nullptr; // where errors go, if not to the log

class LogHandler final : public ::sofa::helper::logging::MessageHandler {
public:
    void process(Message& message) override
    {
        const bool error = message.type() == Message::Error || message.type() == Message::Fatal;
        if (error && collected)
            collected->push_back(message.messageAsString());
        else if (error)
            logError("SOFA: ", message.sender(), ": ", message.messageAsString());
        else if (message.type() == Message::Warning)
            logWarning("SOFA: ", message.sender(), ": ", message.messageAsString());
    }
};

} // namespace

CollectErrors::CollectErrors() { collected = &messages_; }
CollectErrors::~CollectErrors() { collected = nullptr; }

std::recursive_mutex& sofaMutex()
{
    static std::recursive_mutex mutex;
    return mutex;
}

std::string problemNow()
{
    try {
        throw;
    } catch (const std::exception& problem) {
        return problem.what();
    } catch (...) {
        return "an exception that is none of the standard library";
    }
}

bool attempt(const std::string& what, const std::function<void()>& act)
{
    try {
        act();
        return true;
    } catch (...) {
        logError(what, ": ", problemNow());
        return false;
    }
}

void startSofa()
{
    static const bool once = [] {
        ::sofa::simulation::graph::init();
        std::atexit([] { ::sofa::simulation::graph::cleanup(); }); // it warns at the end of a process otherwise
        static auto* const handler = new LogHandler; // never freed: SOFA's own statics may still write at the end
        ::sofa::helper::logging::MessageDispatcher::clearHandlers();
        ::sofa::helper::logging::MessageDispatcher::addHandler(handler);
        return true;
    }();
    static_cast<void>(once);
}

} // namespace filasofia::sofaengine

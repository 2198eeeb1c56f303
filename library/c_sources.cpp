// Recordings and cameras, for C.
#include "library/c_call.h"
#include "library/c_handles.h"

#include <eventide/camera.h>
#include <eventide/reader.h>

#include <functional>
#include <memory>
#include <string>
#include <utility>

using namespace eventide;

namespace {

template <typename Opened, typename... Arguments>
eventide_status open_source(eventide_source** opened, Arguments&&... arguments) {
    *opened = new eventide_source{std::make_unique<Opened>(std::forward<Arguments>(arguments)...)};
    return EVENTIDE_OK;
}

std::string text_or_none(const char* text) {
    return text == nullptr ? "" : text;
}

eventide_callbacks whole_callbacks(const eventide_callbacks* callbacks) {
    return filled_in(eventide_callbacks{}, callbacks, "callbacks");
}

/// `name` of what is waited for.
std::function<void()> ask_while_waiting(const eventide_callbacks& c, const std::string& name) {
    if (c.give_up == nullptr) return {};
    return [c, name] {
        if (c.give_up(c.context) != 0)
            throw Error(ErrorKind::failed, name + ": given up while it was waited for");
    };
}

/// Into the options of a source of this name.
template <typename Options>
void call_back(const eventide_callbacks& c, const std::string& name, Options& options) {
    options.while_waiting = ask_while_waiting(c, name);
    if (c.warn != nullptr)
        options.warn = [c](const std::string& text) { c.warn(c.context, text.c_str()); };
}

}  // namespace

extern "C" {

eventide_status eventide_recording_open(const char* path, const char* format, int width, int height,
                                        eventide_source** opened) {
    const eventide_recording_options options{sizeof options, format, width, height, nullptr};
    return eventide_recording_open_with(path, &options, nullptr, opened);
}

eventide_status eventide_recording_open_with(const char* path,
                                             const eventide_recording_options* options,
                                             const eventide_callbacks* callbacks,
                                             eventide_source** opened) {
    return c_call([&] {
        given(opened, "a place for the source") = nullptr;
        const std::string name = &given(path, "a recording");
        const auto whole = filled_in(eventide_recording_options{}, options, "recording options");
        ReaderOptions chosen{text_or_none(whole.format), whole.width, whole.height};
        chosen.stream = text_or_none(whole.stream);
        call_back(whole_callbacks(callbacks), name, chosen);
        return open_source<EventReader>(opened, name, chosen);
    });
}

eventide_status eventide_camera_open(const char* name, const char* settings, int reconnect,
                                     eventide_source** opened) {
    return eventide_camera_open_with(name, settings, reconnect, nullptr, opened);
}

eventide_status eventide_camera_open_with(const char* name, const char* settings, int reconnect,
                                          const eventide_callbacks* callbacks,
                                          eventide_source** opened) {
    return c_call([&] {
        given(opened, "a place for the source") = nullptr;
        const std::string camera = &given(name, "a camera");
        CameraSettings chosen{text_or_none(settings), reconnect != 0};
        call_back(whole_callbacks(callbacks), camera, chosen);
        return open_source<EventCamera>(opened, camera, chosen);
    });
}

void eventide_source_close(eventide_source* source) {
    delete source;
}

eventide_status eventide_source_add_filter(eventide_source* source, const char* filter) {
    return c_call([&] {
        EventSource& to = *given(source, "a source").it;
        const std::string text = &given(filter, "a filter");
        if (auto* reader = dynamic_cast<EventReader*>(&to))
            reader->add_filter(text);
        else
            dynamic_cast<EventCamera&>(to).add_filter(text);
        return EVENTIDE_OK;
    });
}

int eventide_source_width(const eventide_source* source) {
    return source == nullptr ? 0 : source->it->info().width;
}

int eventide_source_height(const eventide_source* source) {
    return source == nullptr ? 0 : source->it->info().height;
}

eventide_status eventide_reconstructor_open_for(const eventide_source* source, const char* model,
                                                const eventide_options* options,
                                                eventide_reconstructor** opened) {
    return c_call([&] {
        given(opened, "a place for the reconstructor") = nullptr;
        const SensorInfo& sensor = given(source, "a source").it->info();
        return eventide_reconstructor_open(model, sensor.width, sensor.height, options, opened);
    });
}

eventide_status eventide_read(eventide_source* source, const eventide_event** events,
                              size_t* count) {
    return c_call([&] {
        eventide_source& from = given(source, "a source");
        given(events, "a place for events") = nullptr;
        given(count, "a place for the number of events") = 0;
        if (!from.it->read(from.batch)) return EVENTIDE_NONE;
        from.events.clear();
        for (const Event& e : from.batch.events)
            from.events.push_back({to_us(e.t), e.x, e.y, std::uint8_t(e.polarity)});
        *events = from.events.data();
        *count = from.events.size();
        return EVENTIDE_OK;
    });
}

eventide_status eventide_read_into(eventide_source* source, eventide_reconstructor* reconstructor) {
    return c_call([&] {
        eventide_source& from = given(source, "a source");
        Reconstructor& into = given(reconstructor, "a reconstructor").it;
        refuse_other_sensor(*from.it, into);
        if (!from.it->read(from.batch)) return EVENTIDE_NONE;
        push_from(*from.it, from.batch, into);
        return EVENTIDE_OK;
    });
}

eventide_status eventide_read_frame(eventide_source* source, eventide_reconstructor* reconstructor,
                                    eventide_frame* frame) {
    return c_call([&] {
        EventSource& from = *given(source, "a source").it;
        eventide_reconstructor& with = given(reconstructor, "a reconstructor");
        eventide_frame& into = given(frame, "a frame");
        if (!read_frame(from, with.it, with.frame)) return EVENTIDE_NONE;
        return show_frame(with, into);
    });
}

eventide_status eventide_source_clock(const eventide_source* source, int64_t* t) {
    return c_call([&] {
        const auto clock = given(source, "a source").it->clock();
        int64_t& into = given(t, "a place for the time");
        if (!clock) return EVENTIDE_NONE;
        into = to_us(*clock);
        return EVENTIDE_OK;
    });
}

eventide_status eventide_seek(eventide_source* source, int64_t t) {
    return c_call([&] {
        auto* reader = dynamic_cast<EventReader*>(given(source, "a source").it.get());
        if (reader == nullptr)
            throw Error(ErrorKind::usage, "seek: expected a recording, found a camera");
        reader->seek(from_us(t));
        return EVENTIDE_OK;
    });
}

eventide_status eventide_writer_open(const char* path, const char* format, int width, int height,
                                     int overwrite, eventide_writer** opened) {
    return eventide_writer_open_with(path, format, width, height, overwrite, nullptr, opened);
}

eventide_status eventide_writer_open_with(const char* path, const char* format, int width,
                                          int height, int overwrite,
                                          const eventide_callbacks* callbacks,
                                          eventide_writer** opened) {
    return c_call([&] {
        given(opened, "a place for the writer") = nullptr;
        const std::string file = &given(path, "a file's name");
        const SensorInfo sensor{"", "", "", width, height};
        const WriterOptions options{text_or_none(format), overwrite != 0,
                                    ask_while_waiting(whole_callbacks(callbacks), file)};
        *opened = new eventide_writer{{file, sensor, options}};
        return EVENTIDE_OK;
    });
}

eventide_status eventide_write(eventide_writer* writer, const eventide_event* events,
                               size_t count) {
    return c_call([&] {
        eventide_writer& into = given(writer, "a writer");
        into.it.write(events_of(events, count, into.events));
        return EVENTIDE_OK;
    });
}

eventide_status eventide_writer_finish(eventide_writer* writer) {
    return c_call([&] {
        given(writer, "a writer").it.finish();
        return EVENTIDE_OK;
    });
}

void eventide_writer_close(eventide_writer* writer) {
    delete writer;
}
}

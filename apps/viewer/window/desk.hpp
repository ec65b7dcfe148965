// The parts of the window that controllers share, and the base of controllers.
#pragma once

#include <QObject>

namespace palpate::viewer {

class Content;
class Messages;
class Panel;
class Timeline;
class Views;

struct Desk {
    Content& content;
    Messages& messages;
    Views& views;
    Panel& panel;
    Timeline& timeline;
};

/// Does one task of the window (docs/viewer_internals.md).
class Controller : public QObject {
  protected:
    explicit Controller(const Desk& desk)
        : content_(desk.content),
          messages_(desk.messages),
          views_(desk.views),
          panel_(desk.panel),
          timeline_(desk.timeline) {}

    Content& content_;
    Messages& messages_;
    Views& views_;
    Panel& panel_;
    Timeline& timeline_;
};

}  // namespace palpate::viewer

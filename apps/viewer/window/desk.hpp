// The parts of the window that features share, and the base of those without controls.
#pragma once

#include <QObject>

namespace palpate::viewer {

class Content;
class Effect;
class Messages;
class Views;

/// A feature of the window derives from it.
class Desk {
  public:
    Desk(Content& content, Messages& messages, Views& views)
        : content_(content), messages_(messages), views_(views) {}

    /// That of the content, for forms.
    Effect& effect() const;

  protected:
    Content& content_;
    Messages& messages_;
    Views& views_;
};

/// Does one task of the window (docs/viewer_internals.md).
class Controller : public QObject, protected Desk {
  protected:
    explicit Controller(const Desk& desk) : Desk(desk) {}
};

}  // namespace palpate::viewer

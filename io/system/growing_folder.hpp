// A folder of a result that grows where nobody takes it for finished, and takes its place at once.
// Everything that makes a folder of results uses this: conversions, saved edits, work on many
// machines. Linux. Private to io/, stream/ and programs.
#pragma once

#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <string>

namespace palpate::io {

/// The result of `out` grows in result(), inside a folder that Palpate has made, holds locked and
/// recognises. Palpate never deletes, empties or continues a folder that it did not make. All that
/// fails throws OutputError: one line that names what is in the way and says what to do.
class GrowingFolder {
  public:
    /// Throws what is in the way if the folder that it is given must not be replaced.
    using MayReplace = std::function<void(const std::filesystem::path&)>;

    /// In `.palpate-PID-N.part` beside `out`: of this object alone, and removed with it.
    static GrowingFolder alone(const std::filesystem::path& out);
    /// In OUT.partial, which stays when the work is interrupted. If it is there, of the same `job`
    /// (UTF-8), it is continued; if it is of another job, it is removed and begun anew. Refused: a
    /// link, a file, a folder without Palpate's marker, of another user, in use by another process,
    /// or with something in it that Palpate did not write; and if `out` itself is there.
    static GrowingFolder resumable(const std::filesystem::path& out, const std::string& job);
    /// Throws if resumable() would refuse now. Changes nothing.
    static void check_resumable(const std::filesystem::path& out, const std::string& job);
    ~GrowingFolder();
    GrowingFolder(const GrowingFolder&) = delete;
    GrowingFolder& operator=(const GrowingFolder&) = delete;

    /// The folder that becomes `out`. It is there, and empty at the beginning.
    std::filesystem::path result() const { return folder_ / "result"; }
    /// For what is thrown away at the end; not made yet.
    std::filesystem::path work() const { return folder_ / "work"; }
    bool is_continued() const { return is_continued_; }
    /// A sentence if an interrupted run of another job was removed, or if something that Palpate
    /// did not write stays behind.
    const std::string& note() const { return note_; }

    /// Throws if the folder, or its result, was removed, renamed or replaced meanwhile.
    void check() const;
    /// Syncs the result and puts it in the place of `out`. What is there is replaced only if
    /// `may_replace` is given and allows it: exchanged at once or, where the file system cannot do
    /// that, moved aside to OUT.previous first, and back if the result cannot take its place. If
    /// this fails, the result of alone() is kept as OUT.rescued, which the message names.
    void put_in_place(const MayReplace& may_replace = {});

  private:
    struct Earlier;
    static Earlier earlier_run(const std::filesystem::path& folder);

    GrowingFolder(std::filesystem::path out, const std::string* job);
    void make(const std::string* job);
    bool take(const std::string& job);
    void begin_anew();
    void remove_own() noexcept;
    void hold(int folder);
    void close_descriptors() noexcept;
    void move_into_place(const MayReplace& may_replace);
    bool exchange_with_out(const MayReplace& may_replace);
    [[noreturn]] void keep_replaced(const std::filesystem::path& at, const std::string& problem,
                                    bool is_replaced);
    bool replace_in_steps(const MayReplace& may_replace, const struct stat& looked_at);
    void rescue(const std::string& problem) const;

    std::filesystem::path out_, folder_;
    int lock_ = -1, held_result_ = -1;
    bool stays_ = false;  // when it is not put in place
    bool is_continued_ = false;
    std::string note_;
};

/// Looks at what is there, if anything, and again if another process puts something else there
/// meanwhile. Throws what `may_replace` does.
void check_in_place(const std::filesystem::path& path,
                    const GrowingFolder::MayReplace& may_replace);

/// Throws OutputError unless a folder `out` can be made: nothing has its name, and its parent is
/// there and can be written.
void check_new_folder(const std::filesystem::path& out);
/// The same whether something has its name or not.
void check_parent(const std::filesystem::path& name);

}  // namespace palpate::io

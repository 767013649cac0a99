#include "archive/journal.hpp"

#include <sys/vfs.h>

#include <algorithm>
#include <array>

namespace evodevo {
namespace {

/// Type numbers of remote file systems, from linux/magic.h or, for file systems outside the Linux kernel, from their
/// own sources.
constexpr std::array<std::uint32_t, 17> remote_types = {
    0x00006969,  // NFS
    0x0000517b,  // SMB
    0xff534d42,  // CIFS
    0xfe534d42,  // SMB 2
    0x65735546,  // FUSE, including sshfs
    0x01021997,  // 9P
    0x00c36400,  // Ceph
    0x0bd00bd0,  // Lustre
    0x47504653,  // GPFS
    0x19830326,  // BeeGFS
    0xaad7aaea,  // PanFS
    0x20030528,  // OrangeFS
    0x01161970,  // GFS2
    0x7461636f,  // OCFS2
    0x5346414f,  // AFS
    0x73757245,  // Coda
    0x786f4256,  // VirtualBox's shared folders
};

}  // namespace

const char* name(Journal journal) { return journal == Journal::wal ? "wal" : "delete"; }

std::optional<Journal> journal_named(std::string_view given) {
  for (const Journal journal : {Journal::wal, Journal::rollback})
    if (given == name(journal)) return journal;
  return std::nullopt;
}

bool is_remote(std::uint32_t file_system_type) {
  return std::find(remote_types.begin(), remote_types.end(), file_system_type) != remote_types.end();
}

Journal journal_for(const std::filesystem::path& folder) {
  struct statfs about {};
  const bool known = statfs(folder.c_str(), &about) == 0;
  return known && is_remote(static_cast<std::uint32_t>(about.f_type)) ? Journal::rollback : Journal::wal;
}

}  // namespace evodevo

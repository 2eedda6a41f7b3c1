#!/usr/bin/env python3
"""Writes a Debian changelog from the releases of an AppStream metainfo file.

usage: make_changelog.py METAINFO "NAME <ADDRESS>" CHANGELOG.gz
"""
import datetime
import email.utils
import gzip
import pathlib
import sys
import xml.etree.ElementTree as xml


def entry(release, maintainer):
    day = datetime.date.fromisoformat(release.get("date"))
    noon = datetime.datetime.combine(day, datetime.time(12), datetime.timezone.utc)
    items = [item for item in release.find("description").iter() if item.tag in ("p", "li")]
    changes = [" ".join(item.text.split()) for item in items]
    lines = [f"dapple ({release.get('version')}) unstable; urgency=medium", ""]
    lines += [f"  * {change}" for change in changes]
    return "\n".join(lines + ["", f" -- {maintainer}  {email.utils.format_datetime(noon)}", ""])


def main():
    metainfo, maintainer, changelog = sys.argv[1:]
    releases = xml.parse(metainfo).getroot().iter("release")
    text = "\n".join(entry(release, maintainer) for release in releases)
    pathlib.Path(changelog).write_bytes(gzip.compress(text.encode(), mtime=0))


if __name__ == "__main__":
    main()

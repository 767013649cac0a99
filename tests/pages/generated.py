"""Finds and renews the parts of pages that a command writes, between <!-- evodevo ARGUMENTS --> and <!-- end -->."""

import re

from pages import evodevo

PART = re.compile(r"(<!-- evodevo ([^>]*) -->\n)(.*?)(<!-- end -->\n)", re.S)


def parts(text):
    return PART.findall(text)


def renewed(text):
    return PART.sub(lambda part: part[1] + evodevo(*part[2].split()).stdout + part[4], text)

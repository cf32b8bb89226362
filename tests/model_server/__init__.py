"""A loopback server that answers as Gemini, OpenAI, OpenRouter, Anthropic and Ollama do, so that no test needs a
network.

It is as strict as they are: the key in the service's own header, no parameter that a service does not take, pictures
that decode, schemas within the service's limits; errors in the service's own shape. Structured questions are answered
from the request's own schema and prompt, picture requests with a picture made from the one sent. Faults can be queued
(they come first, one a request), or drawn for a share of the requests. ``python -m tests.model_server`` runs it by
hand.

    with ModelServer() as server:
        server.queue(Special(status=500), text_answer("```json\\n{}\\n```"))
        Transport(server.base_urls["gemini"], {"x-goog-api-key": server.key}).post(...)
"""

from tests.model_server.server import ModelServer
from tests.model_server.special import Special, no_picture, raw_answer, text_answer

__all__ = ["ModelServer", "Special", "no_picture", "raw_answer", "text_answer"]
